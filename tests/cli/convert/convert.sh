# Meshes to other formats, units and frames: what was in them, what is lost, one line each.
cubewright make sphere -o s.nrrd --dims 16 -q
cubewright extract s.nrrd --iso 0 -o s.glb -q
cubewright convert s.glb -o s.stl
cubewright convert s.glb -o '{stem}-text.stl' --ascii --unit cm --frame ras
head -n 1 s-text.stl
cubewright convert s-text.stl -o t.ply --ascii -q
grep -e '^format' -e '^comment [ufo]' t.ply
cubewright convert s-text.stl -o t.obj --frame lps --unit m --up y --name ball -q
head -n 2 t.obj
cubewright convert t.obj -o t.off --local -q
head -n 3 t.off

# the same places in every one of them: 59.5231 mm wide
for f in s.stl s-text.stl t.ply t.obj t.off; do
    cubewright check $f | head -n 1
done

# parts: kept, merged, split
cat >two.obj <<'END'
o lower jaw
v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
f 1 3 2
f 1 2 4
f 1 4 3
f 2 3 4
o ../upper
v 5 0 0
v 6 0 0
v 5 1 0
f 5 6 7
END
cubewright convert two.obj -o again.obj --json r.json
sed -n -e '/"parts"/p' -e '/"name": "write"/,/}/p' -e '/"components"/p' -e '/"open_edges"/p' -e '/"dropped"/,/]/p' r.json |
    grep -v -e _bytes -e seconds
grep ^o again.obj
cubewright convert two.obj -o one.obj --merge
cubewright convert two.obj -o one.ply --json - -q | sed -n '/"dropped"/,/]/p'
mkdir out
cubewright convert two.obj --split -o 'out/{part}-{name}.stl' --json r.json
sed -n -e '/"parts": \[/,/^  \]/p' r.json | grep -e name -e path -e '"status"'
grep -c '"params"' r.json
ls -A out
cubewright convert two.obj -o two.stl --no-check
