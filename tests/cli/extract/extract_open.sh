# The plane cuts its box: closed by a cap, or left open.
cubewright make plane -o plane.nrrd --dims 20 -q
cubewright extract plane.nrrd --iso 0 -o closed.ply
cubewright extract plane.nrrd --iso 0 -o open.ply --open
cubewright extract plane.nrrd --iso 0 -o below.ply --inside below --no-open
