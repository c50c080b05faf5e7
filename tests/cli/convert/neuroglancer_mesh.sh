# A mesh as a folder of Neuroglancer's multi-resolution meshes.
cubewright version --features | grep -q '^neuroglancer *yes' || { echo "this build has no Draco" >&2; exit 77; }
cubewright make sphere -o s.nrrd --dims 24 -q
cubewright extract s.nrrd --iso 0 -o s.ply --normals none -q
cubewright convert s.ply -o mesh --format neuroglancer --json mesh.json
ls mesh mesh/segment_properties
cat mesh/info
sed -n '/"output"/,/}/p' mesh.json | grep -e fragments -e step_mm -e '"bits"'
# more nodes for a small tolerance; the old folder is replaced as a whole
cubewright convert s.ply -o mesh/ --format neuroglancer --compress draco --tolerance 0.0005mm
grep -c '"values": \["mesh"\]' mesh/segment_properties/info
# the same bytes again
cubewright convert s.ply -o again --format neuroglancer --compress draco --tolerance 0.0005mm --name mesh -q -t 1
for file in mesh/info mesh/1 mesh/1.index mesh/segment_properties/info; do
    cmp $file again/${file#*/} || echo "differs"
done
# parts become segments
cat >two.obj <<'END'
o left
v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
f 1 3 2
f 1 2 4
f 2 3 4
f 3 1 4
o right
v 5 0 0
v 6 0 0
v 5 1 0
v 5 0 1
f 5 7 6
f 5 6 8
f 6 7 8
f 7 5 8
END
cubewright convert two.obj -o two --format neuroglancer -q
cat two/segment_properties/info
cubewright convert two.obj -o '{name}' --split --format neuroglancer -q
ls left right
try() {
    cubewright convert s.ply --format neuroglancer "$@" -q
    echo "$? $*"
}
mkdir other
echo '{"@type": "neuroglancer_multiscale_volume"}' >other/info
try -o other
try -o s.ply
try -o mesh --no-clobber
try -o none/mesh
try -o new --unit um
try -o new --local
try -o new --compress draco --bits 12
try -o new --compress draco --tolerance 1e-9mm
try -o new --compress quantize
touch mesh/notes.txt
try -o mesh
rm mesh/notes.txt
before=$(cat mesh/1 mesh/1.index | cksum)
(ulimit -f 1; try -o mesh; try -o new) 2>&1 | sed 's/: File too large.*/: File too large/'
[ "$before" = "$(cat mesh/1 mesh/1.index | cksum)" ] && echo "the old one stays"
cubewright convert s.ply -o mesh.ng -q || echo "exit $?"
cat other/info
ls -A
