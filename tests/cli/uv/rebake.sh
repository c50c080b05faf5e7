# a textured mesh: its picture is a normal map
cubewright make torus -o f.nrrd --dims 32 -q
cubewright extract f.nrrd --iso 0 -o full.ply -q
cubewright simplify full.ply -n 1000 -o t.ply --no-measure -q
cubewright uv t.ply --bake full.ply --atlas 256 -o t.glb -q
map() { strings -n 4 "$1" | grep -o -e '"TEXCOORD_0"' -e '"normalTexture"' -e 'image/png' | sort -u | tr '\n' ' '; echo; }

# it stays when triangles go, and through OBJ
cubewright simplify t.glb -n 500 -o s.glb
map s.glb
cubewright simplify t.glb --lod 500,250 -o l.glb --no-measure -q
map l-lod1.glb
cubewright convert t.glb -o t.obj -q
ls t.* t_*
cubewright convert t.obj -o u.glb -q
map u.glb
cubewright convert t.glb -o t.stl

# what makes other triangles says so, and how pictures are carried over
cubewright remesh t.glb --edge 3mm -o r.glb
map r.glb
cubewright uv r.glb --rebake t.glb --atlas 256 -o new.glb --json new.json
map new.glb
sed -n -e '/"pictures": {/,/}/p' new.json
cubewright uv t.glb --atlas 256 -o lost.glb
map lost.glb

cubewright uv r.glb --rebake t.ply -o no.glb
echo $?
cubewright uv r.glb --rebake t.glb -o t.glb
echo $?
cubewright uv r.glb --rebake t.glb -o no.ply
echo $?
