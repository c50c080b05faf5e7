# Surfaces of labels that do not fit --memory: the same files as in memory.
set -e
cubewright make labels/cells -o cells.nrrd --dims 150 --labels 120 --type u8 -q
extract() { cubewright extract cells.nrrd --labels all --memory 36M "$@"; }
extract --stream never -o no.ply -q || echo "exit $?"
mkdir memory files
same() {
    cubewright extract cells.nrrd --labels all -q -o "memory/$@"
    extract -q -o "files/$@"
    diff -r memory files
    echo "$*: the same"
    rm -rf memory/* files/*
}
same 'a.ply' --name a
same 'a.glb' --name a
same 'a.3mf' --name a --smooth-labels off
same 'a.obj' --name a --shared-faces
same '{label}.stl' --name a --no-check --threads 1
same 'cells' --format neuroglancer --labels 3,50-60
extract --stream always -o files/cells.ply --table files/cells.csv --shared-faces --threads 2
cubewright extract cells.nrrd --labels all --table memory/cells.csv --shared-faces -o memory/cells.ply -q
cmp memory/cells.csv files/cells.csv
cmp memory/cells.ply files/cells.ply
# the disk is full
(ulimit -f 4000; extract -q -o files/no.ply) || echo "exit $?"
find . -name 'no.*' -o -name '.cubewright*' | grep . || echo "nothing is left behind"
