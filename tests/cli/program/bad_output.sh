# What is wrong with an output is said before any work, and leaves everything as it was.
cubewright make sphere -o s.nrrd --dims 32 -q
cksum s.nrrd >before
ln s.nrrd s.glb
ln -s s.nrrd s.ply
mkdir folder.glb
echo old >old.glb
try() {
    cubewright extract s.nrrd --iso 0 "$@" -q
    echo "$? $*"
}
try -o nowhere/out.glb
try -o s.nrrd
try -o s.glb
try -o s.ply
try -o folder.glb
try -o out.xyz
try -o out.glb --format draco
try -o old.glb --no-clobber
try -o out.glb --json s.nrrd
(ulimit -f 64; try -o big.glb)
cksum s.nrrd | cmp - before && cat old.glb
ls -A
# every command that writes a mesh or a volume keeps what is there, when asked to
cubewright extract s.nrrd --iso 0 -o t.ply -q
for command in convert smooth repair "remesh --edge 5mm" "simplify --triangles 500" "hollow --wall 2mm" "offset --by 1mm"; do
    cubewright $command t.ply -o old.glb --no-clobber -q
    echo "$? $command"
done
cubewright make sphere -o old.nrrd --dims 8 -q
cubewright make torus -o old.nrrd --dims 8 --no-clobber -q
echo "$? make"
cat old.glb
