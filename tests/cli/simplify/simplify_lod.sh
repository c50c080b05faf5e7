# Levels of detail: a file each, and for glTF one with all of them, of which readers see level 0.
cubewright version --features | grep -q '^simplify *yes' || { echo "this build does not simplify" >&2; exit 77; }
cubewright version --features | grep -q '^glb *yes' || { echo "this build writes no glTF" >&2; exit 77; }
cubewright make sphere -o s.nrrd --dims 32 -q
cubewright extract s.nrrd --iso 0 -o s.glb -q
cubewright simplify s.glb --lod 2k,500,120 -o web.glb --json r.json
ls
sed -n -e '/"lod": \[/,/\]/p' -e '/"levels"/,/^  "output"/p' r.json | tr -d '\n ' | sed 's/[{}]/&\n/g' |
    grep -o -e '"lod":.*\]' -e '"name":"[a-z0-9]*"' -e '"triangles":[0-9]*,"comp' -e '"max":' -e '"status":.*'
# one node is shown, and names the others; each says what it is
for key in MSFT_lod '"ids":\[1,2\]' MSFT_screencoverage '"scenes":\[{"nodes":\[0\]}\]' extensionsRequired; do
    printf '%s %s\n' "$key" "$(head -c 6000 web.glb | grep -a -o "$key" | sort -u | wc -l)"
done
head -c 6000 web.glb | grep -a -o '"triangles":[0-9]*'
cubewright check web.glb | head -n 1
cubewright check web.glb --reference web-lod0.glb --tolerance 0.00001mm -q && echo "level 0 alone"
# compressed, and in formats and names of one's own; a level that is there already stays
cubewright simplify s.glb --lod 500,120 -o small.gltf --compress quantize --no-measure -q && cubewright check small.gltf | head -n 1
mkdir out
cubewright simplify s.glb --lod 6k,90 -o 'out/{stem}_{lod}.ply' --no-measure
cubewright simplify s.glb --lod 400 -o 'out/{lod}.glb' --source s.nrrd --no-measure -q
cubewright simplify s.glb --lod 400,300 -o out/plain.stl --no-measure -q
ls out
try() {
    cubewright simplify s.glb "$@" -q
    echo "$? $*"
}
try --lod 500,120 -o x.glb --error 1mm
try --lod 500,500 -o x.glb
try --lod 120,500 -o x.glb
try --lod 0 -o x.glb
try --lod 500,, -o x.glb
try --lod 5x -o x.glb
try --lod 1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17 -o x.glb
try --lod 500,120 -o 'x-{level}.glb'
try --lod 500,120 -o web.glb --no-clobber
try --lod 500,120 -o x.glb --json x-lod1.glb
ln s.glb y-lod1.glb
try --lod 500,120 -o y.glb
ls | grep '^[xy]'
