# A run in a file: saved, repeated to the same bytes, changed on the command line; what is no run is
# refused, with its line.
cubewright make sphere -o s.nrrd --dims 24 --noise 0.3 -q
cubewright extract s.nrrd --iso 0 --smooth taubin:5 --min-volume 100mm3 --normals none -o a.ply -q --name ball --save-config run.toml
cat run.toml
mv a.ply first.ply
cubewright extract --config run.toml -q && cmp a.ply first.ply && echo "repeated"
cubewright extract --config run.toml --save-config again.toml -q && cmp run.toml again.toml && echo "saved again"
# the command line comes first, and inputs of its own count alone
cubewright extract --config=run.toml --smooth hc -o b.ply -q && cmp -s a.ply b.ply || echo "another surface"
cubewright make torus -o t.nrrd --dims 24 -q
cubewright extract t.nrrd --config run.toml -o t.ply -q && cubewright check t.ply -q && cubewright check t.ply | grep -o '1 handle'
# by hand
cat >hand.toml <<'E'
# sections are of one command
[simplify]
ratio = 0.5
[extract]
inputs = [
    "s.nrrd", # the ball
]
iso = [0, 5]
normals = 'none'
output = "h-{level}.ply"
check = false
smooth = "fair:4vox"
threads = 2
E
cubewright extract --config hand.toml -q && ls h-*
cubewright simplify a.ply --config hand.toml -o half.ply | cut -d: -f1
bad() {
    printf '%b' "$1" >bad.toml
    cubewright extract --config bad.toml
    echo "$?"
}
bad 'iso = 5\nisoo = 5\n'
bad '\n\niso = "five"\n'
bad 'open = maybe\n'
bad 'command = "check"\n'
bad 'config = "x"\n'
bad 'verbose = true\n'
bad 'iso 5\n'
bad '= 5\n'
bad 'iso = \n'
bad 'iso = "5\n'
bad 'iso = "a\\q"\n'
bad 'iso = [5 6]\n'
bad 'iso = [5\n'
bad 'iso = 5 6\n'
bad '[extract\n'
bad 'iso = 5\0\n'
cubewright extract --config none.toml
echo "$?"
cubewright extract s.nrrd --config
echo "$?"
cubewright extract s.nrrd --iso 0 -o c.ply --save-config s.nrrd
echo "$?"
cubewright extract s.nrrd --iso 0 -o c.ply --save-config c.ply
echo "$?"
cubewright extract s.nrrd --iso 99 -o c.ply --save-config failed.toml -q
echo "$?"
ls c.ply failed.toml 2>/dev/null
exit 0
