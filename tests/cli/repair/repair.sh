# Broken meshes become closed manifolds; each defect has a line, and the report has the counts.
cubewright make sphere -o s.nrrd --dims 24 -q
cubewright extract s.nrrd --iso 0 -o binary.stl -q
cubewright convert binary.stl -o s.stl --ascii -q

# every 40th triangle is missing, doubled or flipped: an STL from elsewhere
awk '/facet normal/ { t++; n = 0 } { line[++n] = $0 }
    /endfacet/ {
        if (t % 40 == 10) next
        if (t % 40 == 30) { swap = line[3]; line[3] = line[4]; line[4] = swap }
        for (k = 1; k <= n; k++) print line[k]
        if (t % 40 == 20) for (k = 1; k <= n; k++) print line[k]
        n = 0; next }
    /^solid|^endsolid/ { print; n = 0 }' s.stl >broken.stl
cubewright repair broken.stl -o fixed.stl
cubewright check fixed.stl --profile print --reference s.stl --tolerance 1mm -q && echo "sound"
cubewright repair broken.stl --report-only
echo "exit $?"
cubewright repair fixed.stl --report-only
cubewright repair broken.stl --report-only --json - -q | sed -n '/"repair": {/,/}/p'
for t in 1 3; do cubewright repair broken.stl -o t$t.ply -t $t --name t --no-measure -q; done
cmp t1.ply t3.ply && echo "same"

# a tube: domes, flat ends, or open
cat >tube.obj <<'E2'
v 1 0 0
v 0 1 0
v -1 0 0
v 0 -1 0
v 1 0 3
v 0 1 3
v -1 0 3
v 0 -1 3
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
E2
cubewright repair tube.obj -o flat.obj --flat --no-measure
cubewright repair tube.obj -o open.obj --fill 1mm --no-measure
echo "exit $?"

# parts stay parts; one without volume goes
{ cat tube.obj; printf 'o sheet\nv 9 0 0\nv 8 0 0\nv 9 1 0\nf 9 10 11\n'; } | sed '1i o tube' >parts.obj
cubewright repair parts.obj -o apart.obj -q && grep '^o' apart.obj
sed -n '/^o sheet/,$p' parts.obj | sed 's/f 9 10 11/f 1 2 3/' >sheet.obj
cubewright repair sheet.obj -o none.obj
echo "exit $?"
# corners of neighbours are nearly equal: the distance is found, or given, or not looked for
awk '/vertex/ { printf "vertex %.5f %.5f %.5f\n", $2 + n % 3 * 1e-4, $3, $4; n++; next } { print }' s.stl >loose.stl
cubewright repair loose.stl --weld 0.001mm -o welded.stl -q && cubewright check welded.stl --profile print -q && echo "welded"
cubewright repair loose.stl -o found.stl --no-measure 2>&1 | grep -e welded -e volume
cubewright repair loose.stl --report-only --weld off 2>&1 | grep without
# one side of the cube is finer than the other: a vertex on an edge
cat >joint.obj <<'E2'
v 0 0 0
v 9 0 0
v 0 9 0
v 0 0 9
v 4 0 0
f 1 3 2
f 1 5 4
f 5 2 4
f 1 4 3
f 2 3 4
E2
cubewright repair joint.obj -o joined.obj --no-measure 2>&1 | grep -e split -e volume
cubewright repair joint.obj -o joined.obj --json - -q | grep -e weld -e split_edges -e '"sound'
# a file for the web
cubewright repair broken.stl -o '{stem}-fixed.off' -q && ls broken-fixed.off
