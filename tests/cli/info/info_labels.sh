# A label map: its labels with names and counts, and --labels in place of isovalues.
cat >map.nrrd <<'END'
NRRD0004
type: float
dimension: 3
sizes: 6 2 2
encoding: ascii

9 9 9 70000 70000 70000
9 9 9 70000 70000 70000
0 0 0 5 5 5
0 0 0 70000 70000 70000
END
printf '9 Liver\n5 Left Lung\n' >map.txt
cubewright info map.nrrd
printf '#No. Label Name: R G B A\n9 Liver 1 128 254 0\n70000 Spine 255 0 0 0\n' >lut.txt
cubewright info map.nrrd --names lut.txt --json | sed -n '/"labels": \[/,/^  \]/p;/"levels"/,$p'
cubewright extract map.nrrd --iso 7 -o map.ply -q --no-check
cubewright extract map.nrrd --iso 7 -o map.ply --no-check >/dev/null
# values that are no labels: no note, and isovalues
sed 's/70000/-7/g' map.nrrd >negative.nrrd
cubewright info negative.nrrd | grep -e label -e level
