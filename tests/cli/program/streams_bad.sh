# Uses of `-` that are refused: one line each, the exit code, and no file.
cubewright version --features | grep -q '^glb *yes' || { echo "this build writes no glTF" >&2; exit 77; }
cubewright make torus -o t.nrrd --dims 16 -q
cubewright extract t.nrrd --iso 0 -o mesh.stl -q
run() {
    cat t.nrrd | cubewright "$@" -q >out 2>err
    echo "$? $(wc -c <out) $(cat err)"
}
run extract - --iso 0 -o -
run extract - --iso 0 -o - --format nope
run extract - --iso 0 -o - --format stl --json -
run extract - --iso 0,1 -o - --format stl
run extract - --iso 0 --lod 40,20 -o - --format glb
run extract - --iso 0 -o - --format neuroglancer
run extract - --iso 0 --pvd - -o x.vtp
run extract - --batch --iso 0 -o '{stem}.stl'
run extract t.nrrd --batch --iso 0 -o - --format stl
run boolean - - --op union -o x.stl
run check - --source - --iso 0
run check mesh.stl --defects -
run simplify - --triangles 10 -o x.stl
run make torus -o -
head -c 300 t.nrrd >t.cut
cubewright extract - --iso 0 -o - --format stl -q <t.cut
echo $?
cubewright extract - --iso 0 -o - --format stl -q </dev/null
echo $?
printf 'NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: raw\ndata file: a.raw\n\n' |
    cubewright extract - --iso 0 -o - --format stl -q
echo $?
printf 'mtllib red.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' |
    cubewright check - --mesh-reader obj -q
echo $?
cat t.nrrd | cubewright extract - --iso 0 -o - --format stl -q >/dev/full
echo $?
cat t.nrrd | TMPDIR=/none/there cubewright extract - --iso 0 -o - --format stl -q | cmp - mesh.stl
cat t.nrrd | cubewright extract - --iso 0 -o - --format stl -q >&-
echo $?
ls
