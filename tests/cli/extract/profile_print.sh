# --profile print: the largest component or those that are asked for, and what check would say.
cubewright make hard/mc33 -o mc.nrrd -q
cubewright make torus -o t.nrrd --dims 48 -q
cubewright make ct-head -o ct.nrrd --dims 48 -q
cubewright extract t.nrrd --iso 0 -o t.stl --profile print --wall 25mm --json r.json
sed -n -e '/"profile"/p' -e '/"largest"/p' -e '/"min_wall_mm"/p' -e '/"least_mm"/p' r.json
cubewright extract t.nrrd --iso 0 -o t.3mf --profile print -q && cubewright check t.3mf --profile print -q && echo "as check says"
cubewright extract mc.nrrd --iso 0 -o m.stl --profile print -q
echo "$?"
cubewright check m.stl | head -1
cubewright extract ct.nrrd --iso 300 -o two.stl --profile print --largest 2 -q && cubewright check two.stl | grep -o '[0-9]* components\?'
cubewright extract ct.nrrd --iso 300 -o some.stl --profile print --min-volume 1mm3 -q && cubewright check some.stl | grep -o '[0-9]* components\?'
cubewright extract t.nrrd --iso 0 -o big.stl --profile print --plate 50x50x50mm -q
echo "$?"
ls big.stl
bad() {
    cubewright extract "$@" -q
    echo "$? $*"
}
bad t.nrrd --iso 0 -o bad.stl --profile print --open
bad t.nrrd --iso 0 -o bad.stl --profile print --lod 100
bad t.nrrd --iso 0 -o bad.stl --profile print --stream always
bad t.nrrd --labels all -o bad.stl --profile print
bad t.nrrd --iso 0 -o bad.stl --profile web
bad t.nrrd --iso 0 -o bad.stl --wall 1mm
bad t.nrrd --iso 0 -o bad.stl --profile print --no-check
ls bad* 2>/dev/null
exit 0
