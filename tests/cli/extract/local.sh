# A thin sphere a kilometre from zero: world coordinates in single precision lose it, and the run
# says so; coordinates relative to the mesh's origin do not, and the origin is told. GLB needs no help.
cubewright make sphere -o s.nii --dims 65 -q
tail -c 1098500 s.nii >voxels.raw
cat >far.nhdr <<'HEADER'
NRRD0004
type: float
dimension: 3
space: left-posterior-superior
sizes: 65 65 65
space directions: (0.1,0,0) (0,0.1,0) (0,0,5)
space origin: (1000000,1000000,1000000)
encoding: raw
endian: little
data file: voxels.raw
HEADER
for f in stl ply obj glb; do
    cubewright extract far.nhdr --iso 0 -o world.$f
    cubewright extract far.nhdr --iso 0 -o local.$f --local
done
for options in '-o world.stl' '-o local.stl --local' '-o world.glb'; do
    cubewright extract far.nhdr --iso 0 $options -q --json - | sed -n '/"output": \[/,/"status"/p'
done
grep -a -h origin local.ply local.obj
head -c 80 local.stl | tr -d '\000'; echo
grep -a -c translation world.glb local.glb
cubewright extract s.nii --iso 0 -o near.stl
