# A surface in parts: made in any order, by processes of their own, and joined to the same bytes.
set -e
. "$TESTS/support/wait.sh"
cubewright make gyroid -o g.nrrd --dims 40x30x50 --type i16 --noise 0.2 --seed 3 -q
for format in ply glb stl vtp obj 3mf; do
    cubewright extract g.nrrd --iso 100 -o whole.$format --name a --stream never -q
done
for parts in 1 3 8 90; do
    for k in $(seq $parts -1 1); do
        cubewright extract g.nrrd --iso 100 --part $k/$parts --manifest m$parts -q
    done
    for format in ply glb stl vtp obj 3mf; do
        cubewright join m$parts -o joined.$format --name a -q
        cmp whole.$format joined.$format
    done
    echo "$parts parts: the same"
done
# at once, with one part in more than one process
rm -r m3
for k in 1 2 3 2 1; do cubewright extract g.nrrd --iso 100 --part $k/3 --manifest m3 -q & done
wait
cubewright join m3 -o joined.ply --name a
cmp whole.ply joined.ply
cubewright extract g.nrrd --iso 100 --part 2/3 --manifest m3
# killed at any time, it is made when it is run again
has_begun_or_is_over() {
    [ -n "$(find r -type f ! -name '*.cwpart' ! -name manifest.json 2>/dev/null)" ] || is_over "$1"
}
cubewright make gyroid -o h.nrrd --dims 120 --type i16 --noise 0.2 --seed 3 -q
cubewright extract h.nrrd --iso 100 -o whole.ply --name a --stream never -q
for k in 1 2 3 4 5 6 7 8 9; do
    cubewright extract h.nrrd --iso 100 --part $k/9 --manifest r -q &
    worker=$!
    [ $((k % 2)) = 0 ] || wait_until has_begun_or_is_over $worker
    kill -KILL $worker 2>/dev/null || true
    wait $worker 2>/dev/null || true
    cubewright extract h.nrrd --iso 100 --part $k/9 --manifest r -q
done
cubewright join r -o resumed.ply --name a -q
cmp whole.ply resumed.ply && echo "killed nine times: the same"
# errors say what is wrong
try() { "$@" -q || echo "exit $?"; }
try cubewright extract g.nrrd --iso 101 --part 2/3 --manifest m3
try cubewright extract g.nrrd --iso 100 --part 2/4 --manifest m3
try cubewright extract g.nrrd --iso 100 --part 4/3 --manifest m3
try cubewright extract g.nrrd --iso 100 --part 1/3
try cubewright extract g.nrrd --iso 100 --part 1/3 --manifest m3 -o a.ply
try cubewright extract g.nrrd --iso 100 --part 1/3 --manifest m3 --simplify 0.5vox
try cubewright extract g.nrrd --iso 100,200 --part 1/3 --manifest m3
try cubewright extract g.nrrd --iso 100 --parts 3 --part 1/3 --manifest m3
printf 'x' | dd of=m3/part-2-of-3.cwpart bs=1 seek=5000 conv=notrunc 2>/dev/null
try cubewright join m3 -o no.ply
head -c 5000 m3/part-1-of-3.cwpart >m3/part-2-of-3.cwpart
try cubewright join m3 -o no.ply
cp m3/part-1-of-3.cwpart m3/part-2-of-3.cwpart
try cubewright join m3 -o no.ply
rm m3/part-2-of-3.cwpart
try cubewright join m3 -o no.ply
echo '{"schema": "other"}' >m3/manifest.json
try cubewright join m3 -o no.ply
try cubewright join nothing -o no.ply
try cubewright join m3
# all samples on one side: no surface, though every part meets the border
cubewright extract g.nrrd --iso -1e6 --part 1/2 --manifest full -q
cubewright extract g.nrrd --iso -1e6 --part 2/2 --manifest full -q
try cubewright join full -o no.ply
ls no.* m3/.cubewright* 2>/dev/null || echo "nothing is left behind"
# a file that exists is kept
cubewright extract g.nrrd --iso 100 --part 1/1 --manifest one -q
echo old >old.ply
try cubewright join one -o old.ply --no-clobber
cat old.ply
cubewright join one -o old.ply -q && cmp -n 3 old.ply whole.ply && echo "replaced"
# outputs over a part, and a manifest that is a pipe
cubewright extract g.nrrd --iso 100 --part 1/1 --manifest two -q
cp two/part-1-of-1.cwpart kept
ln two/part-1-of-1.cwpart linked.ply
try cubewright join two -o two/part-1-of-1.cwpart --format ply
try cubewright join two -o linked.ply
try cubewright join two -o two/manifest.json --format ply
cmp kept two/part-1-of-1.cwpart && echo "the part is kept"
rm two/manifest.json
mkfifo two/manifest.json
try timeout 20 cubewright join two -o no.ply
try timeout 20 cubewright extract g.nrrd --iso 100 --part 1/1 --manifest two
