# The minimum inside an object: air around it does not hide it.
cubewright version --features | grep -q '^gl *yes' || { echo "this build has no OpenGL" >&2; exit 77; }
cubewright make ct-head -o h.nrrd --dims 32 -q
# draw OPTIONS...: the settings used, and how many of the picture's greys there are.
draw() {
    cubewright render h.nrrd --mode minip --size 64x48 -q --background '#00ff00' --json r.json -o x.png "$@" || echo "exit $?"
    grep -o '"minip_inside": [a-z]*' r.json
    cubewright render h.nrrd --size 64x48 -q --background '#00ff00' --json c.json -o c.png \
        --compare "minip,no-minip-inside|minip${1:+,${1#--}}"
    grep -o '"rmse": [0-9.e-]*' c.json | awk '{ print ($2 > 20 ? "unlike" : $2 > 0 ? "near" : "as"), "the whole ray" }'
}
draw
draw --no-minip-inside
draw --threshold=-200
echo "nothing reaches it:"
cubewright render h.nrrd --mode minip --threshold 1e6 --size 16x16 -q --background none -o none.png
cubewright render h.nrrd --mode composite --opacity 0 --size 16x16 -q --background none -o hidden.png 2>hidden.txt
cmp none.png hidden.png && echo "the background"
cubewright render h.nrrd --mode mip --minip-inside -o x.png
echo "exit $?"
ls
