# The report holds the same facts; two runs differ in seconds and peak_bytes only.
cubewright make torus -o t.nrrd --dims 32 -q
cubewright extract t.nrrd --iso 0 -o t.glb --json a.json -q
cubewright extract ./t.nrrd --iso 0 -o t.glb --json - -q >b.json
for f in a b; do
    sed -e '/"cgal"/d' -e '/"simplify"/d' -e '/"level-set"/d' -e '/"seconds"/d' -e '/"peak_bytes"/d' -e '/"json":/d' -e 's/"\.\/t.nrrd"/"t.nrrd"/' $f.json >$f
done
cmp a b && cat a
cubewright extract t.nrrd --iso 99 -o u.glb --json - -q | grep -e '"status"' -e '"message"' -e '"exit"'
