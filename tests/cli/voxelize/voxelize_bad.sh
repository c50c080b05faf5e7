# Meshes and grids that make no sense; parts too thin for the voxels are told.
cubewright make sphere -o s.nrrd --dims 16 -q
cubewright extract s.nrrd --iso 0 -o s.ply -q
cubewright extract s.nrrd --iso 0 --crop 0:7,0:15,0:15 --open -o open.ply -q
for options in "s.ply -o v.nrrd" "s.ply -o v.stl --spacing 1mm" "s.ply -o v.nrrd --spacing 1mm --like s.nrrd" \
    "open.ply -o v.nrrd --spacing 2mm" "s.ply open.ply -o v.nrrd --spacing 2mm" "missing.ply -o v.nrrd --spacing 1mm" \
    "s.ply -o v.nrrd --like missing.nrrd" "s.ply -o v.nrrd --spacing 1mm --box 1:2,1:2,1:2" \
    "s.ply -o v.nrrd --spacing 1mm --box 900mm:910mm,0mm:9mm,0mm:9mm" "s.ply -o s.ply --spacing 1mm" \
    "s.ply -o v.nrrd --spacing 0.001mm --memory 64M"; do
    # shellcheck disable=SC2086
    cubewright voxelize $options -q
    echo "exit $?"
done
ls v.nrrd 2>/dev/null
cat >thin.off <<'E2'
OFF
8 12 0
0 0 0.2
9 0 0.2
9 9 0.2
0 9 0.2
0 0 0.4
9 0 0.4
9 9 0.4
0 9 0.4
3 0 2 1
3 0 3 2
3 4 5 6
3 4 6 7
3 0 1 5
3 0 5 4
3 2 3 7
3 2 7 6
3 1 2 6
3 1 6 5
3 0 4 7
3 0 7 3
E2
cubewright voxelize thin.off --spacing 1mm --box -2mm:11mm,-2mm:11mm,-3mm:5mm -o v.nrrd
echo "exit $?"
cubewright info s.nrrd --within open.ply
echo "exit $?"
cubewright info s.nrrd --within missing.ply
echo "exit $?"
