# Two modes or settings in one picture, and how far they are apart.
cubewright version --features | grep -q '^gl *yes' || { echo "this build has no OpenGL" >&2; exit 77; }
cubewright make ct-head -o h.nrrd --dims 24 -q
render() {
    cubewright render h.nrrd --size 64x48 -q "$@"
    echo "$?"
}
cubewright render h.nrrd --size 64x48 --compare 'composite|composite' --no-preintegration -o same.png
cubewright render h.nrrd --size 64x48 --compare 'composite,step-length=4|step-length=0.5' --no-preintegration -o s.png
render --compare 'no-lit|tf=fog' --no-preintegration --difference 10 --json r.json -o wide.png
od -A n -t u1 -j 16 -N 8 wide.png
grep -c -e '"rmse"' -e '"delta_e_p99"' r.json
render --compare 'composite' -o x.png
render --compare 'a|b|c' -o x.png
render --compare 'composite|ray' -o x.png
render --compare 'composite|step=2' -o x.png
render --compare 'composite|json=r.json' -o x.png
render --compare 'composite|mip,no-lit' -o x.png
render --compare 'composite|mip' --threshold 3 -o x.png
render --compare 'mesh|composite' -o x.png
echo "each projection beside its own reference"
for mode in mip minip minip,no-minip-inside minip,threshold=-200 average local-mip,threshold=30; do
    cubewright render h.nrrd --size 64x48 --compare "$mode,cell-steps|reference" -q --json m.json -o x.png
    grep -o '"rmse": [0-9.e-]*' m.json | awk '{ print ($2 < 1.5 ? "an error" : "no error: " $2) }'
done
cubewright render h.nrrd --size 64x48 --compare 'mip|composite' -o x.png
render --compare 'composite,step-length=0|composite' -o x.png
render --difference 2 -o x.png
render --compare 'composite|composite' --difference 0 -o x.png
ls
