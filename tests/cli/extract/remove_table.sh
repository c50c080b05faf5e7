# All but the body of a CT becomes air; the body's surface stays where it is.
cubewright make ct-head -o head.nrrd --dims 48 --type i16 --noise 200 --seed 2 -q
cubewright extract head.nrrd --iso skin -o dust.stl
cubewright extract head.nrrd --iso skin --remove-table -o head.stl --json r.json
grep remove_table r.json
cubewright extract head.nrrd --iso skin --remove-table -t 1 -o one.stl -q
cmp head.stl one.stl && echo same
cubewright check head.stl --source head.nrrd --iso skin --remove-table 2>&1 | grep -e topology -e air
cubewright info head.nrrd --remove-table 2>&1 | grep air
cubewright make sphere -o ball.nrrd --dims 16 -q
cubewright extract ball.nrrd --iso 0 --remove-table -o no.stl -q
echo $?
cubewright extract head.nrrd --labels all --remove-table -o no.stl -q
echo $?
