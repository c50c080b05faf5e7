# There and back: the voxels of a surface are those above its isovalue; names of parts, partial volumes, and values inside.
cubewright make sphere -o s.nrrd --dims 24 -q
cubewright extract s.nrrd --iso 0 -o s.ply -q
cubewright voxelize s.ply --like s.nrrd -o s.nii.gz
cubewright extract s.nii.gz --iso 0.5 -o back.ply -q
cubewright check back.ply --reference s.ply --tolerance 3.01mm -q && echo "within 0.87 voxels"
cubewright info s.nii.gz

# two parts with names, of two files
cat >cube.obj <<'E2'
o left & right
v 0 0 0
v 4 0 0
v 0 4 0
v 4 4 0
v 0 0 4
v 4 0 4
v 0 4 4
v 4 4 4
f 1 3 4 2
f 5 6 8 7
f 1 2 6 5
f 3 7 8 4
f 1 5 7 3
f 2 4 8 6
E2
for f in c.seg.nrrd c.nii c.mha; do cubewright voxelize s.ply cube.obj --spacing 2mm -o $f -q && cubewright info $f | grep ' voxels '; done
cubewright voxelize s.ply cube.obj --spacing 2mm -o c.mha
cubewright voxelize cube.obj --spacing 1mm --box 0mm:3mm,0mm:4mm,2mm:9mm --partial -o p.nrrd --json - |
    sed -n -e '/"parts"/,/"lost"/p'

# the same bytes for any number of threads
for t in 1 5; do cubewright voxelize s.ply --spacing 1.5mm --partial -o t.nrrd -t $t -q; mv t.nrrd t$t; done
cmp t1 t5 && echo "same"

# values inside of each part
cubewright info s.nrrd --within cube.obj | grep within
cubewright info s.nrrd --within cube.obj --json | sed -n -e '/^  "within"/,/"half_inside"/p'
