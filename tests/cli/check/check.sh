# Verdicts: a sphere that is as it should be, and a solid with a hole.
cubewright make sphere -o s.nrrd --dims 32 -q
cubewright extract s.nrrd --iso 0 -o s.glb -q
cubewright check s.glb --profile print --source s.nrrd --iso 0 --tolerance 0.1mm
cubewright check s.glb --profile fem
echo "exit $?"
cat >open.off <<'END'
OFF
4 3 0
0 0 0
9 0 0
0 9 0
0 0 9
3 0 2 1
3 0 1 3
3 0 3 2
END
cubewright check open.off && echo fine
cubewright check open.off --profile print --defects open.ply --json open.json
echo "exit $?"
grep -c '^property uchar' open.ply
grep -e '"command"' -e '"profile"' -e '"grade": "fail"' -e '"open_edges"' -e '"self_intersections"' \
    -e '"status"' -e '"message"' -e '"exit"' -e '"compression"' open.json
# the same facts for one thread and for three, and by any reader
cubewright extract s.nrrd --iso 0 -o s.ply -q
for t in 1 3; do
    cubewright check s.ply --deep --source s.nrrd --iso 0 -t $t --json - -q |
        grep -v -e '"threads"' -e seconds -e peak_bytes >$t
done
cmp 1 3 && echo "same report"
# against another mesh: shifted by a tenth
cubewright make sphere -o t.nrrd --dims 32 --type f32 -q
cubewright extract t.nrrd --iso 0.1 -o t.ply -q
cubewright check t.ply --reference s.ply --tolerance 0.05mm -q
echo "exit $?"
# a bar of 40 is in proportion, rounded up: no share is without one
cubewright check t.ply --histogram 2>/dev/null |
    awk '/ %  /{ n = gsub("#", "#"); for (i = 2; i <= NF; i++) if ($i == "%") s = 0.4 * $(i - 1)
        bad += n < s - 0.03 || n > s + 1.03 || (s > 0 && n == 0); bars++ }
        END { print bars, "bars,", bad + 0, "wrong" }'
cubewright check t.ply --reference s.ply --tolerance 0.11mm -q --histogram
echo "exit $?"
# in proportion: the diagonal of its box is 103.73 mm, a voxel 2.58065 mm
for tolerance in 0.09% 0.11% 0.03vox 0.045vox; do
    cubewright check s.ply --reference t.ply --source s.nrrd --iso 0 --tolerance $tolerance -q --json r.json
    echo "exit $? $(grep tolerance_mm r.json)"
done 2>/dev/null
# glTF: bounds and factors that are wrong fail for the web, and are no matter of the solid
cubewright extract s.nrrd --iso 0 -o made.gltf -q
for change in s/x/x/ 's/"max":\[[^,]*/"max":[9.5/' 's/"min":\[[^,]*/"min":[9.5/' 's/"metallicFactor":[0-9.]*/"metallicFactor":7/' \
    's/"baseColorFactor":\[0/"baseColorFactor":[-0/'; do
    sed "$change" made.gltf >g.gltf
    cubewright check g.gltf --profile web 2>/dev/null | grep -e FAIL -e 'meets profile' | sed 's/; .*s$//'
    cubewright check g.gltf >/dev/null 2>&1 || echo "refused"
done
