# Levels of detail of a surface in one go: the same as extract and then simplify --lod.
cubewright version --features | grep -q '^simplify *yes' || { echo "this build does not simplify" >&2; exit 77; }
cubewright version --features | grep -q '^glb *yes' || { echo "this build writes no glTF" >&2; exit 77; }
cubewright make sphere -o s.nrrd --dims 32 -q
cubewright extract s.nrrd --iso 0 --lod 2k,500,120 -o web.glb --json r.json
ls
sed -n -e '/"lod": \[/,/\]/p' -e '/"levels"/,/^  "output"/p' r.json | tr -d '\n ' | sed 's/[{}]/&\n/g' |
    grep -o -e '"lod":.*\]' -e '"name":"[a-z0-9]*"' -e '"triangles":[0-9]*,"comp' -e '"max":' -e '"status":.*'
for key in MSFT_lod '"ids":\[1,2\]' '"scenes":\[{"nodes":\[0\]}\]' NORMAL; do
    printf '%s %s\n' "$key" "$(head -c 6000 web.glb | grep -a -o "$key" | sort -u | wc -l)"
done
head -c 6000 web.glb | grep -a -o -e '"isovalue":"[^"]*"' -e '"simplified":"[^"]*"'
head -c 6000 web-lod1.glb | grep -a -o '"simplified":"[^"]*"'
# the same surfaces as in two steps, from any number of threads
cubewright extract s.nrrd --iso 0 -o s.glb -q
cubewright simplify s.glb --lod 2k,500,120 -o two.glb --source s.nrrd --no-measure -q
cubewright extract s.nrrd --iso 0 --lod 2k,500,120 -o one.glb --no-check -q -t 1 --name web
cubewright extract s.nrrd --iso 0 --lod 2k,500,120 -o many.glb --no-check -q -t 4 --name web
cmp one.glb many.glb && echo "same bytes"
for level in 0 1 2; do
    cubewright check web-lod$level.glb --reference two-lod$level.glb --tolerance 0.00001mm -q && echo "same level $level"
done
# other names and formats; open surfaces; parts of the volume; without normals and small components
mkdir out
cubewright extract s.nrrd --iso 0 --lod 6k,90 -o 'out/{stem}_{lod}.ply' --no-measure
cubewright make gyroid -o g.nrrd --dims 24 -q
cubewright extract g.nrrd --iso 0 --open --lod 900 -o out/open.stl --no-measure
cubewright extract s.nrrd --iso 0 --crop 0:15,0:31,0:31 --lod 700 --min-volume 500mm3 --normals none -o out/half.obj --no-measure
cubewright extract s.nrrd --iso 0 --preview --lod 60 -o out/p.gltf --compress quantize --no-measure
cubewright extract s.nrrd --batch --iso 0 --lod 400,300 -o 'out/{stem}-b.stl' --no-measure -q
ls out
# --simplify is not measured either
cubewright extract s.nrrd --iso 0 --simplify 500 -o plain.ply --no-measure
# each level tells what was done to the surface
cubewright extract s.nrrd --iso 0 --fill-voids --lod 400,300 -o v.stl --no-measure -q --json v.json
grep -c '"voids_filled"' v.json
