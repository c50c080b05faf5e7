# One mesh held against its volume: the level is found again, distances are those of check, another
# surface is told as one, and the page has the mesh in three dimensions.
cubewright make sphere -o sphere.nrrd --dims 24 -q
cubewright make torus -o torus.nrrd --dims 24 -q
cubewright extract sphere.nrrd --iso 3 -o ball.stl -q
number_of() { # number_of KEY FILE: the first one
    sed -n "s/^ *\"$1\": \\([-0-9.e]*\\).*/\\1/p" "$2" | head -n 1
}
within() { # within VALUE EXPECTED TOLERANCE TEXT
    awk "BEGIN {d = $1 - ($2); exit !(d <= $3 && -d <= $3)}" && echo "$4" || echo "$4: not so, $1"
}

cubewright report ball.stl --source sphere.nrrd -o ball.html --json ball.json || exit 1
sed -n 's/^  "schema": //p; s/^  "level": //p; s/^  "closed": //p' ball.json
within "$(number_of iso ball.json)" 3 0.001 "the level is found"
cubewright check ball.stl --source sphere.nrrd --iso "$(number_of iso ball.json)" --json check.json -q
for key in max_mm rms_mm p99_mm; do
    [ "$(number_of $key ball.json)" = "$(number_of $key check.json)" ] && echo "$key: as of check"
done
OMP_NUM_THREADS=1 cubewright report ball.stl --source sphere.nrrd -o again.html -q
cmp ball.html again.html && echo "the same bytes by one thread"
grep -o '<strong>It is [^<]*' ball.html
grep -c '<script type="text/plain" data-name="the mesh"' ball.html
[ "$(grep -o 'data-triangles="[0-9]*"' ball.html | tr -dc '0-9')" = "$(number_of triangles ball.json)" ] ||
    echo "other triangles"
if python3 -c 'import xml.dom.minidom' 2>/dev/null; then
    python3 -c 'import xml.dom.minidom, sys; xml.dom.minidom.parse(sys.argv[1])' ball.html || echo "no XML"
fi
sh -c "$(sed -n 's/^  "command": "\(.*\)",$/\1/p' ball.json) -q" && echo "its command runs"

# How it looks: figures and pictures beside the surface, as check has them; with a map in three pictures.
grep -o 'alt="[^"]*worst view"' ball.html
cubewright extract sphere.nrrd --iso 3 -o surface.ply -q
cubewright check ball.stl --reference surface.ply --looks none --json looks.json -q
for f in ball looks; do sed -n '/^  "looks"/,/^  }/p' $f.json >$f.looks; done
cmp ball.looks looks.looks && echo "looks: as of check"
if cubewright version --features | grep -q '^glb *yes'; then
    cubewright make sphere -o coarse.nrrd --dims 9 -q
    cubewright extract coarse.nrrd --iso 3 -o coarse.ply -q
    cubewright uv coarse.ply --bake surface.ply --atlas 256 -o map.glb -q
    cubewright report map.glb --source sphere.nrrd --iso 3 -o map.html --json map.json -q
    grep -c -e 'alt="The mesh without its maps, worst view"' -e '>with its maps<' map.html
    grep -o '"without_maps"' map.json
else
    echo 2
    echo '"without_maps"'
fi

# A mesh of filtered voxels has no level of these: that is said, unless the filter is named.
cubewright make gyroid -o noisy.nrrd --dims 40 --noise 0.3 --seed 2 -q
cubewright extract noisy.nrrd --iso 0.2 --denoise gauss:1vox -o filtered.stl -q
for filter in none gauss:1vox; do
    [ $filter = none ] && set -- || set -- --denoise $filter
    cubewright report filtered.stl --source noisy.nrrd -o filtered.html --json filtered.json "$@" | sed 's/: 99 .*//'
    sed -n 's/^ *"unsure": //p' filtered.json
    grep -c 'the mesh was made from filtered voxels' filtered.html
done

# An open mesh is held against an open surface.
cubewright extract torus.nrrd --iso -12 --open -o open.stl -q
cubewright report open.stl --source torus.nrrd -o open.html --json open.json -q
sed -n 's/^  "open": //p' open.json
grep -o '<strong>It is [^<]*' open.html
sh -c "$(sed -n 's/^  "command": "\(.*\)",$/\1/p' open.json)" | tail -n 1 | sed 's/; .*//'

# Another level is another surface, and so is one of another volume.
cubewright report ball.stl --source sphere.nrrd --iso -6 -o other.html --json other.json -q
grep -o '<strong>It is [^<:]*' other.html
sed -n 's/^  "level": //p' other.json
cubewright report ball.stl --source torus.nrrd -o torus.html -q
grep -o '<strong>It is [^<:]*' torus.html

# Without a source, and with options of the other kind, it is refused.
try() {
    cubewright report "$@"
    echo "$?"
}
mkdir empty && cd empty || exit 1
try ../ball.stl -o x.html
try ../ball.stl --source ../sphere.nrrd -o x.html --budget 3s
try ../sphere.nrrd -o x.html --mesh-reader stl
try ../ball.stl --source ../none.nrrd -o x.html
try ../ball.stl --source ../sphere.nrrd -o ../sphere.nrrd
try ../sphere.nrrd --source ../sphere.nrrd -o x.html
ls -A
