# Crossings near one sample become one vertex; the error is in the line and in the report.
cubewright make sphere -o s.nrrd --dims 32 -q
cubewright extract s.nrrd --iso 0 -o plain.ply --name s
cubewright extract s.nrrd --iso 0 -o s.ply --snap 0.4
cubewright extract s.nrrd --iso 0 -o s.stl --snap 0.4 --json - -q |
    sed -n -e '/"snap": 0/p' -e '/"snap": {/,/}/p'
cubewright extract s.nrrd --iso 0 -o off.ply --name s --snap 0 -q
cmp plain.ply off.ply
for bad in 0.6 -1; do
    cubewright extract s.nrrd --iso 0 -o s.ply --snap $bad || echo "exit $?"
done
