# The outer boundary: what --outer drops is told, and a hollow ball is full again. A cavity stays without it.
cubewright make sphere -o ball.nrrd --dims 24 -q
cubewright extract ball.nrrd --iso 0 -o ball.stl -q
cubewright hollow ball.stl --wall 3mm -o shell.stl -q
cubewright repair shell.stl --report-only
cubewright repair shell.stl --report-only --outer
echo "exit $?"
cubewright repair shell.stl --outer -o full.stl --json full.json -q
cubewright check full.stl --profile basic -q && echo "sound"
awk '/"inner_shells"|"outer"/ { gsub(",", ""); print $1, $2 }' full.json
cubewright check full.stl --reference ball.stl --tolerance 0.00001mm -q && echo "the ball"

# parts of a file: the one inside goes
cat >parts.obj <<'E2'
o outer
v 0 0 0
v 9 0 0
v 0 9 0
v 0 0 9
f 1 3 2
f 1 2 4
f 1 4 3
f 2 3 4
o inner
v 1 1 1
v 2 1 1
v 1 2 1
v 1 1 2
f 5 7 6
f 5 6 8
f 5 8 7
f 6 7 8
E2
cubewright repair parts.obj --outer -o one.obj
cubewright repair one.obj --report-only --outer
