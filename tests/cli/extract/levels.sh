# Several levels of one volume: a file each, the same as one at a time, with the octree and without.
cubewright make ct-head -o ct.nii.gz --dims 48 --noise 20 -q
cubewright extract ct.nii.gz --iso 300,-400,0.25 -o 'all-{level}.stl' --name head
for level in 300 -400 0.25; do
    cubewright extract ct.nii.gz --iso $level -o '{stem}.stl' --name head -q
    cubewright extract ct.nii.gz --iso 300,-400,0.25 -o 'none-{level}.stl' --accel none --name head -q
    cmp ct.stl "all-$level.stl" && cmp ct.stl "none-$level.stl" && echo "same at $level"
done
ls && rm ./*.stl

# Options are for all of them; names of levels are short, and say all.
cubewright extract ct.nii.gz --iso=-0,1e2,1000e-1,5e-1 -o '{level}.ply' -q
echo $?
mkdir out
cubewright extract ct.nii.gz --iso=-0,1e2,0.1,-1.5e-7 -o 'out/{stem}_{level}_{{{level}}.ply' --open \
    --normals none --local --inside below --topology simple --crop 0:40,0:40,0:20
ls out && rm -r out

# A level that crosses nothing is told; the others are made. The report has them all.
cubewright extract ct.nii.gz --iso 300,9000,-9000,0 -o '{level}.glb' --json r.json -q
echo $?
sed -n -e '/"surfaces"/,$p' r.json |
    grep -v -e _ -e box -e area -e volume -e degenerate -e euler -e genus -e duplicates -e needles -e caps
grep -c -e '"params"' -e '"accel": "octree"' r.json
rm ./*.glb r.json

# Refused before the volume is read, which here is none.
echo nothing >no.nrrd
echo old >out-2.glb
ln -s out-2.glb out-1.glb
ln -s no.nrrd out-5.glb
try() {
    cubewright extract no.nrrd "$@" -q
    echo "$? $*"
}
try --iso 1,2 -o out.glb
try --iso 1,2 -o some.dir/out
try --iso 1,2 -o 'out-{level}-{lod}.glb'
try --iso 1 -o 'out-{}.glb'
try --iso 1 -o 'out-{level.glb'
try --iso 1,2,1.0 -o 'out-{level}.glb'
try --iso 1,2 -o 'out-{level}.glb'
try --iso 3,4 -o 'out-{level}.glb' --json out-4.glb
try --iso 3,5 -o 'out-{level}.glb'
try --iso 3,2 -o 'out-{level}.glb' --no-clobber
try --iso 3,4 -o 'out-{level}.xyz'
try --iso 3,4 -o '{level}/out.glb'
try --iso 1,2, -o 'out-{level}.glb'
try --iso "$(seq -s, 65)" -o 'out-{level}.glb'
try --iso 3,4 -o 'out-{level}.glb' --accel fast
ls -A
