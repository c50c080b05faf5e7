# -q: nothing but results that were asked for; -v: a line a step; -vv: settings too.
cubewright make torus -o t.nrrd --dims 16 -q
cubewright extract t.nrrd --iso 0 -o t.ply -q
cubewright extract t.nrrd --iso 0 -o t.ply -v 2>&1 >/dev/null | cut -c 1-8
cubewright extract t.nrrd --iso 0 -o t.ply -vv 2>&1 >/dev/null | cut -c 1-8
cubewright extract t.nrrd --iso 0 -o t.ply --no-check
