# What repair refuses, before the input is read or after; nothing is written then.
cubewright make sphere -o s.nrrd --dims 16 -q
cubewright extract s.nrrd --iso 0 -o s.off -q
printf 'OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n' >empty.off
printf 'OFF\n3 1 0\n0 0 nan\n1 0 0\n0 1 0\n3 0 1 2\n' >nan.off
cat >tip.off <<'E2'
OFF
8 8 0
0 0 0
9 0 0
0 9 0
0 0 9
2 2 0
1 1 -5
4 1 -5
1 4 -5
3 0 2 1
3 0 1 3
3 0 3 2
3 1 2 3
3 4 6 5
3 4 7 6
3 4 5 7
3 5 6 7
E2
try() {
    cubewright repair "$@" -q
    echo "$? $*"
}
try s.off
try s.off -o x.stl --report-only
try s.off -o x.stl --fill 0mm
try s.off -o x.stl --fill=-1mm
try s.off -o x.stl --weld nan
try s.off -o x.stl --wrap 5kg
try s.off -o x.stl --fill 0.5vox
try s.off -o x.xyz
try s.off -o s.off
try s.off -o x.stl --json s.off
try s.off -o x.stl --json x.stl
try s.off -o x.stl --compress draco
try s.off -o x.stl --max-triangles 9
try s.off -o nowhere/x.stl
try s.nrrd -o x.stl
try empty.off -o x.stl
try nan.off -o x.stl
try none.off -o x.stl
try tip.off -o x.stl --max-move 0.000001mm
try tip.off --report-only --max-move 0.000001mm
try tip.off -o x.stl --max-move -1mm
try s.off s.off -o x.stl
try s.off -o x.stl --fil 1mm
ls -A
