# Cuts the surface that is extracted by a plane: what is said and reported, and what is refused.
cubewright make sphere -o s.nrrd --dims 40 -q
cubewright extract s.nrrd --iso 0 -o a.ply --cut-plane z=5mm --json r.json
sed -n -e '/"cut_plane"/p' -e '/"cut": {/,/}/p' r.json
cubewright extract s.nrrd --iso 0 -o b.ply --cut-plane=-z=10%
cubewright extract s.nrrd --iso 0 -o c.ply --cut-plane 0,0,0:1,1,1 --smooth taubin
for t in 1 3; do cubewright extract s.nrrd --iso 0 -o t$t.ply --cut-plane x=1mm -t $t --name t -q; done
cmp t1.ply t3.ply && echo "same"
bad() {
    cubewright extract "$@" -q
    echo "$? $*"
}
bad s.nrrd --iso 0 -o bad.ply --cut-plane z
bad s.nrrd --iso 0 -o bad.ply --cut-plane w=1
bad s.nrrd --iso 0 -o bad.ply --cut-plane z=5kg
bad s.nrrd --iso 0 -o bad.ply --cut-plane z=nan
bad s.nrrd --iso 0 -o bad.ply --cut-plane 0,0,0:0,0,0
bad s.nrrd --iso 0 -o bad.ply --cut-plane 0,0:0,0,1
bad s.nrrd --iso 0 -o bad.ply --cut-plane z=5m
bad s.nrrd --iso 0 -o bad.ply --cut-plane z=5mm --stream always
bad s.nrrd --labels all -o bad.ply --cut-plane z=5mm
bad s.nrrd --iso 0 --cut-plane z=5mm --part 1/2 --manifest m
ls bad* 2>/dev/null
exit 0
