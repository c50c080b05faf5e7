# How alike two meshes look: figures, limits, normal maps of GLB, and the same for any number of threads.
cubewright version --features | grep -q '^glb *yes' || { echo "this build has no glTF" >&2; exit 77; }
cubewright make torus -o f.nrrd --dims 48 -q
cubewright make torus -o c.nrrd --dims 20 -q
cubewright extract f.nrrd --iso 0 -o full.ply -q
cubewright extract c.nrrd --iso 0 -o low.ply -q
cubewright check full.ply --reference full.ply --looks none 2>/dev/null | grep -e looks -e inside -e equal
cubewright check low.ply --reference full.ply --looks 4,20dB 2>/dev/null | grep -e ' looks ' -e inside -e dB
for limit in 0.2 4,60dB; do
    cubewright check low.ply --reference full.ply --looks $limit >found
    echo "exit $?: $(grep -c -e 'FAIL *looks' -e 'bake a normal map' found)"
done
# not what can be: limits, and looks without another mesh
for limit in "" 0 -1 x 25db 2dBx 2,,3 2x3 inf none,2; do
    cubewright check low.ply --reference full.ply --looks "$limit" -q || echo "exit $?"
done
cubewright check low.ply --looks none -q || echo "exit $?"

# a mesh without normals is flat, as viewers show it
cubewright convert low.ply -o flat.stl -q
cubewright check flat.stl --reference full.ply --looks none 2>&1 | grep -e flat, -e beside

# elsewhere: said, and seen
cubewright convert low.ply --pivot base -o moved.ply -q
cubewright check moved.ply --reference full.ply --looks none 2>&1 | grep -e 'middle' -e beside

# a normal map: as uv measures it, and as check reads it from the file
cubewright uv low.ply --bake full.ply --atlas 512 --looks 4 --json uv.json -o low.glb 2>/dev/null | grep -o 'looks: .* without maps)'
cubewright check low.glb --reference full.ply --looks 4 --json a.json -t 1 2>/dev/null | grep -e 'looks,' -e maps -e worst
cubewright check low.glb --reference full.ply --looks 4 --json b.json -q -t 3 >/dev/null
for f in uv a b; do sed -n '/^  "looks"/,/^  }/p' $f.json >$f.looks; done
cmp a.looks b.looks && echo "same for 1 and 3 threads"
cmp a.looks uv.looks && echo "same for the file"
grep -c '"name": "az' a.looks
grep -m 1 -A 9 '"all"' a.looks
cubewright uv low.ply --bake full.ply --atlas 512 --looks 0.01 -o not.glb -q || echo "exit $?"
cubewright uv low.ply --looks 4 -o not.glb -q || echo "exit $?"
ls not.glb 2>/dev/null

# maps that cannot be decoded, or not be read
LC_ALL=C sed 's/\x89PNG/\xff\xd8\xff\xe0/' low.glb >jpeg.glb
cubewright check jpeg.glb --reference full.ply --looks none 2>&1 | grep -e JPEG -e beside
LC_ALL=C sed 's/IHDR/IHDX/' low.glb >broken.glb
cubewright check broken.glb --reference full.ply --looks none -q >/dev/null || echo "exit $?"
LC_ALL=C sed 's/"source":0/"source":9/' low.glb >odd.glb
cubewright check odd.glb --reference full.ply --looks none 2>/dev/null | grep -e beside -e 'its maps'
