# Texture coordinates: what is printed and reported, files that hold them, and the same bytes for any number of threads.
cubewright version --features | grep -q '^glb *yes' || { echo "this build has no glTF" >&2; exit 77; }
cubewright make torus -o t.nrrd --dims 32 -q
cubewright extract t.nrrd --iso 0 -o t.ply -q
cubewright uv t.ply -o t.glb
cubewright uv t.ply -o t.obj -q
cubewright uv t.ply -o t.stl -q
for t in 1 3; do cubewright uv t.ply -o t$t.glb -t $t --name t -q; done
cmp t1.glb t3.glb && echo "same"
strings -n 4 t.glb | grep -o TEXCOORD_0

# OBJ: coordinates within the square, and corners that name them
awk '$1 == "vt" { n++; bad += $2 < 0 || $2 > 1 || $3 < 0 || $3 > 1 }
     $1 == "f" { for (k = 2; k <= 4; k++) { split($k, at, "/"); bad += at[2] < 1 || at[2] > n; f++ } }
     END { print (n > 0 && f > 0 && !bad ? "in the square" : "bad " bad) }' t.obj

# parts share one square
cubewright make labels/cells -o l.nrrd --dims 24 --labels 4 --type u16 -q
cubewright extract l.nrrd --labels all -o l.obj -q
cubewright uv l.obj -o parts.obj -q
grep -c '^o ' parts.obj

# the report
cubewright uv t.ply -o u.glb --atlas 1024 --margin 4 --json - -q | sed -n -e '/"params"/,/}/p' -e '/"atlas": {/,/}/p'

# a density, and one that does not fit
cubewright uv t.ply -o d.glb --texel-density 2 -q && echo "2 texels a mm"
cubewright uv t.ply -o e.glb --texel-density 200
echo $?
cubewright uv t.ply -o e.glb --atlas 32
echo $?
cubewright uv t.ply -o e.glb --margin 0
echo $?
cubewright uv t.ply -o e.glb --texel-density -1
echo $?
ls e.glb 2>/dev/null
cubewright help --search unwrap | head -n 3

# a normal map of a finer mesh, in the file with tangents; formats without pictures hold none
cubewright make torus -o f.nrrd --dims 64 -q
cubewright extract f.nrrd --iso 0 -o full.ply -q
cubewright uv t.ply --bake full.ply --atlas 256 -o n.glb --json n.json -q
strings -n 4 n.glb | grep -o -e 'TANGENT' -e '"normalTexture":{"index":0}' -e 'image/png'
sed -n -e '/"maps": {/,/}/p' n.json
for t in 1 4; do cubewright uv t.ply --bake full.ply --atlas 256 -o n$t.glb --name n -t $t -q; done
cmp n1.glb n4.glb && echo "same"
cubewright uv t.ply --bake full.ply -o n.ply
echo $?
cubewright uv t.ply --bake full.ply --maps curvature,thickness --map-bits 16 --atlas 256 -o m.obj | grep -o "maps of full.ply"
ls m-*.png
cubewright uv t.ply --bake full.ply --maps curvature --atlas 256 --no-clobber -o m2.obj -q && ls m2*
cubewright uv t.ply --bake full.ply --maps colors -o n.glb -q
echo $?
cubewright uv t.ply --reach 1mm -o n.glb
echo $?
cubewright uv t.ply --bake nothing.ply -o n.glb
echo $?
