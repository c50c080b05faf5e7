# A run in a file: saved, repeated to the same bytes, changed on the command line; a report repeats its
# run; what is no run is refused, with its field.
cubewright make sphere -o s.nrrd --dims 24 --noise 0.3 -q
cubewright extract s.nrrd --iso 0 --smooth taubin:5 --min-volume 100mm3 --normals none -o a.ply -q --name ball --save-config run.json
cat run.json
mv a.ply first.ply
cubewright extract --config run.json -q && cmp a.ply first.ply && echo "repeated"
cubewright extract --config run.json --save-config again.json -q && cmp run.json again.json && echo "saved again"
# the command line comes first, and inputs of its own count alone
cubewright extract --config=run.json --smooth hc -o b.ply -q && cmp -s a.ply b.ply || echo "another surface"
cubewright make torus -o t.nrrd --dims 24 -q
cubewright extract t.nrrd --config run.json -o t.ply -q && cubewright check t.ply -q && cubewright check t.ply | grep -o '1 handle'
# a report holds its run; without times and the sizes of memory it is the same
facts() { grep -v -E '"(seconds|peak_bytes)"' "$1"; }
cubewright simplify a.ply --ratio 0.5 -v -o half.ply --json half.json >log 2>&1
facts half.json >first.json
mv half.ply first.ply
cubewright simplify --config half.json -q && cmp half.ply first.ply && facts half.json | cmp first.json - && echo "a report repeats its run"
cubewright info s.nrrd --json >info.json && cubewright info --config info.json | cmp info.json - && echo "info too"
# by hand
cat >hand.json <<'J'
{"inputs": ["s.nrrd"],
 "options": {"iso": [0, 2.5], "normals": "none", "output": "h-{level}.ply", "check": false,
             "smooth": "fair:4vox", "threads": 2, "max-triangles": 100000000}}
J
cubewright extract --config hand.json -q && ls h-*
bad() {
    printf '%b' "$1" >bad.json
    cubewright extract --config bad.json
    echo "$?"
}
bad '{"options": {"iso": 5, "isoo": 5}}'
bad '{"options": {"iso": "five"}}'
bad '{"options": {"iso": true}}'
bad '{"options": {"iso": [5, [6]]}}'
bad '{"options": {"iso": []}}'
bad '{"options": {"open": "maybe"}}'
bad '{"options": {"open": 1}}'
bad '{"options": {"config": "x"}}'
bad '{"options": {"verbose": true}}'
bad '{"options": ["iso"]}'
bad '{"command": "check"}'
bad '{"command": 5}'
bad '{"inputs": "s.nrrd"}'
bad '{"inputs": ["s.nrrd", 5]}'
bad '{"iso": 5}'
bad '{"run": 5}'
bad '[5]'
bad '{"options": {"iso": 5, "iso": 6}}'
bad '{"options":\n {"iso" 5}}'
bad '{"options": {"output": "a\\u0000"}}'
bad ''
cubewright simplify --config run.json
echo "$?"
cubewright extract --config none.json
echo "$?"
cubewright extract s.nrrd --config
echo "$?"
cubewright extract s.nrrd --iso 0 -o c.ply --save-config s.nrrd
echo "$?"
cubewright extract s.nrrd --iso 0 -o c.ply --save-config c.ply
echo "$?"
cubewright extract s.nrrd --iso 99 -o c.ply --save-config failed.json -q
echo "$?"
ls c.ply failed.json 2>/dev/null
exit 0
