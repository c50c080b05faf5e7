# convert --profile: a mesh becomes an asset with levels, texture coordinates and a normal map, whatever its size.
cubewright version --features | grep -q '^glb *yes' || { echo "this build has no glTF" >&2; exit 77; }
cubewright version --features | grep -q '^simplify *yes' || { echo "this build does not simplify" >&2; exit 77; }
cubewright make ct-head -o v.nrrd --dims 64 -q
cubewright extract v.nrrd --iso 300 --largest 1 -o a.stl -q
cubewright make labels/cells -o l.nrrd --dims 24 --labels 4 --type u16 -q
cubewright extract l.nrrd --labels all -o parts.obj -q
for p in game web mobile; do
    cubewright convert a.stl --profile $p -o $p.glb --json $p.json -q || echo "failed: $?"
    cubewright check $p.glb --profile $p | grep -e weight -e 'file size'
    grep -c '"switch_distance_m"' $p.json
    strings -n 4 $p.glb | grep -o -e TEXCOORD_0 -e image/png -e KHR_draco_mesh_compression -e EXT_meshopt_compression | sort -u | tr '\n' ' ' && echo
done
ls *.glb

# parts become one; a mesh with fewer triangles than a level has no such level
cubewright convert parts.obj --profile game -o p.glb --json p.json -q && grep -c '"name": "lod[0-9]"' p.json
cubewright convert a.stl --profile game --pivot centre --compress none -o c.glb --json c.json -q
sed -n -e '/"profile"/p' -e '/"pivot"/p' -e '/"compression"/p' c.json
cubewright convert a.stl --profile game --pivot base -o game.glb -q && cubewright convert game.glb -o g.obj -q && awk '$1 == "v" && (!n++ || $4 < low) { low = $4 } END { print "lowest", low + 0 }' g.obj

# a mesh in other units: the same numbers, a thousand times smaller
cubewright convert a.stl --scale 0.001 -o s.ply -q
cubewright convert s.ply --profile game -o s.glb -q && echo small

# pictures are carried over: colours of another volume, and occlusion
cubewright make sphere -o paint.nrrd --dims 64 -q
cubewright extract v.nrrd --iso 300 --largest 1 --simplify 4k --uv --maps normals,colors,occlusion --color-by paint.nrrd --atlas 256 \
    -o painted.glb -q
textures() { strings -n 4 "$1" | grep -o -e baseColorTexture -e occlusionTexture -e normalTexture -e COLOR_0 | sort -u | tr '\n' ' ' && echo; }
textures painted.glb
cubewright convert painted.glb --profile mobile -o carried.glb -q
textures carried.glb
cubewright check carried.glb --reference painted.glb --looks 2 -q && echo "looks alike"
bad() {
    cubewright convert a.stl "$@" -q
    echo "$? $*"
}
bad --profile game -o x.stl
bad --profile game --split -o 'x{part}.glb'
bad --profile print -o x.glb
ls x* 2>/dev/null
exit 0
