# Components of labels that are too small go to their neighbours, and voids of labels are filled.
cat >map.nrrd <<'END'
NRRD0004
type: unsigned short
dimension: 3
sizes: 7 5 3
encoding: ascii
space: left-posterior-superior
space directions: (2,0,0) (0,1,0) (0,0,1)

1 1 1 2 2 0 0
1 1 1 2 2 0 0
1 1 1 2 2 0 9
1 1 1 2 2 0 0
1 1 1 2 2 0 0
1 1 1 2 2 0 0
1 0 1 2 2 0 0
1 1 1 2 1 0 0
1 1 2 2 2 0 3
1 1 1 2 2 0 3
1 1 1 2 2 0 0
1 1 1 2 2 0 0
1 1 1 2 2 0 0
1 1 1 2 2 0 0
1 1 1 2 2 0 0
END
cubewright extract map.nrrd --labels all --min-volume 2vox --fill-voids -o clean.ply --name x --table clean.csv --json clean.json
cut -d, -f1,8,15- clean.csv
grep -A5 '"cleaned"' clean.json | head -6
# 4 mm3 are two voxels
cubewright extract map.nrrd --labels all --min-volume 4mm3 --fill-voids -o same.ply --name x -q
cmp clean.ply same.ply && echo same
cubewright extract map.nrrd --labels all --largest 1 -o one.ply --table one.csv
cut -d, -f1,8,15- one.csv
cubewright extract map.nrrd --labels 9,3 --min-volume 3vox -o none.ply; echo "exit $?"
cubewright extract map.nrrd --labels all --largest 1 --stream always -o bad.ply; echo "exit $?"
cubewright help --search dust | head -3
