# Labels whose volume smoothing cannot keep are named: those of a few voxels that touch in edges.
cat >specks.nrrd <<'END'
NRRD0004
type: unsigned char
dimension: 3
sizes: 8 4 2
encoding: ascii

1 0 0 2 0 4 0 5
0 1 0 0 2 0 5 0
0 0 3 0 0 4 0 0
0 3 0 4 4 0 6 6
0 1 0 2 0 0 0 0
1 0 0 0 2 0 5 0
0 3 3 0 0 4 0 5
0 0 0 4 4 4 6 6
END
cubewright extract specks.nrrd --labels all -o specks.ply --table table.csv --json specks.json
cut -d, -f1,8,9,15 table.csv
sed -n '/"labels_off_volume"/,/]/p' specks.json | head -3
cubewright extract specks.nrrd --labels 3,6 -o two.ply -q --table two.csv && cut -d, -f1,15 two.csv
# surfaces that are open, or not smoothed, promise nothing
cubewright extract specks.nrrd --labels all -o open.ply --open -q --table open.csv && cut -d, -f1,15 open.csv | tail -1
cubewright extract specks.nrrd --labels all -o raw.ply --smooth-labels off
