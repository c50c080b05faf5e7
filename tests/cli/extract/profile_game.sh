# --profile game, web and mobile: one file that an engine takes, within the budget that check reads, too.
cubewright version --features | grep -q '^glb *yes' || { echo "this build has no glTF" >&2; exit 77; }
cubewright version --features | grep -q '^simplify *yes' || { echo "this build does not simplify" >&2; exit 77; }
cubewright make ct-head -o v.nrrd --dims 64 --noise 40 -q
cubewright extract v.nrrd --iso 300 --profile game --lod 3k,1k --atlas 256 --pivot base -o a.glb --json a.json -q
ls a*.glb
strings -n 4 a.glb | grep -o -e 'MSFT_lod' -e 'TEXCOORD_0' -e TANGENT -e image/png | sort | uniq -c
sed -n -e '/"profile"/p' -e '/"pivot"/p' -e '/"largest"/p' -e '/"fill_voids"/p' -e '/"switch_distance_m"/p' \
    -e '/"size": 256/p' -e '/"moved_to_pivot_mm"/p' a.json
cubewright check a.glb --profile game | grep -e weight -e 'file size'
cubewright convert a.glb a.obj -q && awk '$1 == "v" && (!n++ || $4 < low) { low = $4 } END { print "lowest", low + 0 }' a.obj
for t in 1 3; do cubewright extract v.nrrd --iso 300 --profile mobile --lod 3k,1k -t $t --name t -o t$t.glb -q; done
cmp t1.glb t3.glb && echo same
strings -n 4 t1.glb | grep -c EXT_meshopt_compression

# what is given wins; levels in files of their own
cubewright extract v.nrrd --iso 300 --profile game --lod 3k,1k --atlas 128 --maps none --compress quantize -o b{lod}.glb -q
ls b*.glb
strings -n 4 b1.glb | grep -o -e TANGENT -e image/png -e KHR_mesh_quantization -e TEXCOORD_0 | sort -u

# the stages by themselves
cubewright extract v.nrrd --iso 300 --largest 1 --simplify 3k --uv --maps normals --atlas 128 --pivot centre -o s.glb --json s.json -q
sed -n -e '/"maps": "/p' -e '/"texels": /p' -e '/"pivot"/p' s.json
cubewright extract v.nrrd --iso 300 --largest 1 --simplify 3k --uv -o s.obj -q && grep -q '^vt ' s.obj && echo "vt"

bad() {
    cubewright extract v.nrrd --iso 300 "$@" -q
    echo "$? $*"
}
bad --profile game --lod 40 -o x.glb
bad --profile game -o x.stl
bad --profile game --open -o x.glb
bad --uv --maps normals -o x.glb
bad --maps normals --simplify 3k -o x.glb
bad --uv --maps shadows --simplify 3k -o x.glb
bad --uv --atlas 7 -o x.glb
bad --uv --stream always -o x.glb
ls x* 2>/dev/null
exit 0
