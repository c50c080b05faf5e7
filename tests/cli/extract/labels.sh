# Labels: all in one file with names and colours, or a file each; chosen by number, range and name.
cat >map.nrrd <<'END'
NRRD0004
type: unsigned short
dimension: 3
sizes: 5 4 3
encoding: ascii
space: left-posterior-superior
space directions: (1,0,0) (0,1,0) (0,0,2)
space origin: (10,0,0)

1 1 2 2 0
1 1 2 2 0
1 1 2 2 0
0 0 0 0 0
1 1 2 2 0
1 1 2 2 0
1 1 2 2 0
0 0 0 0 300
1 1 2 2 0
1 1 2 2 0
0 0 0 0 0
0 0 0 0 300
END
cat >names.csv <<'END'
LabelValue,Name,Color_R,Color_G,Color_B,Color_A
1,Left Lung,1,128,254,255
2,Right Lung,9,8,7,51
300,"Node, small",255,0,0,255
END
cubewright extract map.nrrd --labels all --names names.csv -o map.obj --table map.csv --json map.json
grep -e '^o ' -e '^usemtl' -e '^mtllib' map.obj
cat map.mtl map.csv
sed '/^  "run"/,/^  }/d' map.json | sed -n -e '/"names"/,/}/p' -e '/"params"/,/}/p'
sed -n '/"labels": \[/,/^  \]/p' map.json | sed -n '1,24p'
# the table gives the same names and colours again
cubewright extract map.nrrd --labels all --names map.csv -o map.ply -q --table again.csv
cmp map.csv again.csv && echo same
# a file each
cubewright extract map.nrrd --labels '2-300,left*' --names names.csv -o '{stem}-{label:03d}-{name}.stl' --normals none
ls map-*
# unsmoothed, and within a length
cubewright extract map.nrrd --labels 1 -o one.off --smooth-labels off
cubewright extract map.nrrd --labels 1,2 -o two.off --smooth-labels 0.2mm -q --json - | grep smooth_labels
# the interfaces once, with both labels
cubewright extract map.nrrd --labels all -o faces.ply --shared-faces
cubewright extract map.nrrd --labels all -o faces.obj --shared-faces --names names.csv -q && grep '^o ' faces.obj
# other threads and an open border
cubewright extract map.nrrd --labels all -o t1.ply -q -t 1 --name x
cubewright extract map.nrrd --labels all -o t2.ply -q -t 2 --name x
cmp t1.ply t2.ply && echo same
cubewright extract map.nrrd --labels all -o open.ply --open
# names beside the volume, and labels that are not there
cp names.csv map.csv
cubewright extract map.nrrd --labels 'LEFT LUNG,7' -o left.ply
bad() { cubewright extract map.nrrd -o bad.ply "$@" || echo "exit $?"; }
bad --labels 1,7 --require-labels
bad --labels lung
bad --labels 'left lng'
bad --labels 0
bad --labels 3-2
bad --labels 1,,2
bad --labels 7
bad --labels 1 --iso 3
bad --labels 1 --pixel-error 1
bad --labels all --smooth-labels 3mm
bad --labels all --smooth-labels fine
bad --labels all --shared-faces -o 'bad-{label}.ply'
bad --labels all --shared-faces -o bad.stl
bad --labels all --table names.csv --names names.csv
bad --labels all --names missing.csv
bad --labels all -o 'bad-{labels}.ply'
bad --iso 1 --names names.csv
bad --labels all --table map.nrrd
ls bad* 2>/dev/null || echo none
# a scan: all of its values are labels only if that is insisted on
cubewright make gyroid -o grey.nrrd --dims 12 --noise 1 --type u8 -q
cubewright extract grey.nrrd --labels all -o bad.ply || echo "exit $?"
cubewright extract grey.nrrd --labels all --force -o grey.ply -q && echo forced
cubewright extract grey.nrrd --labels 3,4 -o grey.ply -q && echo chosen
