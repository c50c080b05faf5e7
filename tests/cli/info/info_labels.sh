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
# what is predicted is what extract makes: all in memory, some labels, a part of the rows, slice by slice
cubewright make labels/cells -o cells.nrrd --dims 40x44x36 --type u16 --labels 30 -q
predict() { # FILE OPTIONS...
    cubewright info "$@" --json | sed -n 's/^ *"\(labels\|triangles\|shared_triangles\|streamed\|overflows\)": \([0-9a-z]*\),$/\1 \2/p'
}
predict cells.nrrd --labels all
cubewright extract cells.nrrd --labels all -o cells.stl -q --no-check
echo "extract $((($(wc -c <cells.stl) - 84) / 50))"
predict cells.nrrd --labels 3,5-9
cubewright extract cells.nrrd --labels 3,5-9 -o some.stl -q --no-check
echo "extract $((($(wc -c <some.stl) - 84) / 50))"
cubewright info cells.nrrd --labels all | tail -4
cubewright make labels/cells -o large.nrrd --dims 256x256x700 --type u8 --labels 30 -q
predict large.nrrd --labels all --memory 64M
cubewright info large.nrrd --labels all --memory 64M | sed -n 's/^ *memory//p'
cubewright info cells.nrrd --labels 99 || echo "exit $?"
cubewright info cells.nrrd --labels Liver || echo "exit $?"
cubewright make gyroid -o gyroid.nrrd --dims 20 -q
cubewright info gyroid.nrrd --labels all || echo "exit $?"
