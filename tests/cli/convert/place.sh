# Meshes scaled, mirrored, turned and moved to a pivot, and split into their solids.
cubewright make sphere -o s.nrrd --dims 16 -q
cubewright extract s.nrrd --iso 0 -o s.stl -q
box() {
    cubewright convert s.stl -o t.ply "$@" && cubewright check t.ply | head -n 1
}
box --scale 2,1,0.5 --pivot base
box --scale 2,1,0.5 --rotate z:90 --pivot centre
box --scale 2,1,0.5 --rotate z:90,x:-90 --mirror x --json - -q | grep -e "\"scale\": \[" -e "\"mirror\"" -e "\"rotate\"" | sort -u
box --rotate z:30 --scale 0.001 --pivot base
# the outside stays outside, and the same turn twice is none
cubewright convert s.stl -o m.ply --mirror z -q && cubewright check m.ply | grep outward
cubewright convert s.stl -o a.ply --name s --rotate y:90,y:270 -q && cubewright convert s.stl -o b.ply --name s -q && cmp a.ply b.ply && echo same
# placed, then cut: half of it is above z = 0
cubewright convert s.stl -o half.stl --pivot base --cut-plane z=50% -q && cubewright check half.stl | head -n 1
# every part by the same map
cat >two.obj <<'END'
o low
v 0 0 0
v 1 0 0
v 0 1 0
f 1 2 3
o high
v 0 0 5
v 1 0 5
v 0 1 5
f 4 5 6
END
cubewright convert two.obj -o three.obj --pivot base --scale 2 --no-check && grep '^v' three.obj
# one part is split into its solids, the largest first, cavities with what is around them
cat >nest.obj <<'END'
v 0 0 0
v 10 0 0
v 0 10 0
v 0 0 10
v 1 1 1
v 4 1 1
v 1 4 1
v 1 1 4
v 20 0 0
v 25 0 0
v 20 5 0
v 20 0 5
f 9 11 10
f 9 10 12
f 9 12 11
f 10 11 12
f 5 6 7
f 5 8 6
f 5 7 8
f 6 8 7
f 1 3 2
f 1 2 4
f 1 4 3
f 2 3 4
END
cubewright convert nest.obj --split -o '{stem}-{part}.stl'
cubewright check nest-1.stl | head -n 1
bad() {
    cubewright convert s.stl -o bad.stl "$@" -q
    echo "$? $*"
}
bad --scale 0
bad --scale -1
bad --scale 1,2
bad --scale 2mm
bad --scale 1e39
bad --rotate 90
bad --rotate w:90
bad --rotate z:90,
bad --rotate z:1,z:1,z:1,z:1,z:1,z:1,z:1,z:1,z:1
bad --mirror xy
bad --pivot top
ls bad.stl 2>/dev/null
exit 0
