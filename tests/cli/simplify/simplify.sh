# Fewer triangles: under an error, to a number, to a share; what was promised, and what is said.
cubewright version --features | grep -q '^simplify *yes' || { echo "this build does not simplify" >&2; exit 77; }
cubewright make sphere -o s.nrrd --dims 32 -q
cubewright extract s.nrrd --iso 0 -o s.glb -q
cubewright simplify s.glb -o e.glb --error 0.2mm
cubewright simplify s.glb -o p.stl -e 0.2% -q
cubewright simplify s.glb -o '{stem}-n.ply' --triangles 0.5k
cubewright simplify s.glb -o r.obj --ratio 0.25 --no-measure --allow-intersections
# what is met first: 500 triangles are there long before 5 mm
cubewright simplify s.glb -o n.ply --triangles 500 --error 5mm -q
head -n 30 n.ply | grep -a '^element'
cubewright simplify s.glb -o few.ply -n 100 -e 0.05mm
# others agree on error and topology, and the normals are the field's
cubewright check e.glb --reference s.glb --tolerance 0.2mm -q && echo "check agrees"
cubewright simplify s.glb -o f.ply -n 300 --source s.nrrd --iso 0 --ascii
# of a sphere that is the radius: the cosine of the largest angle between them
sed '1,/end_header/d' f.ply | awk 'NF == 6 { r = sqrt($1*$1 + $2*$2 + $3*$3)
    d = ($1*$4 + $2*$5 + $3*$6) / r; if (!n++ || d < least) least = d }
    END { print n, (least > 0.99999 ? "exact" : least) }'
# the same bytes for any number of threads
for t in 1 3; do
    cubewright simplify s.glb -o t$t.glb --error 0.1mm -t $t --name t -q
done
cmp t1.glb t3.glb && echo "same"

# the report
cubewright simplify s.glb -o e.glb --error 0.2mm --json - -q |
    sed -n -e '/"input"/,/}/p' -e '/"steps"/,/^  "mesh"/p' -e '/"error": \[/,$p' |
    grep -v -e seconds -e _bytes -e sha256

# parts are simplified apart, and stay parts; corners at one place become one
cubewright extract s.nrrd --iso 0 -o a.obj --name a -q
cubewright extract s.nrrd --iso 8 -o b.obj --name b -q
{ cat a.obj; awk -v n="$(grep -c '^v ' a.obj)" '/^f/ { for (i = 2; i <= 4; i++) { split($i, p, "/"); $i = p[1] + n "//" p[1] + n } } { print }' b.obj; } >two.obj
cubewright simplify two.obj -o less.obj --triangles 800
grep '^o' less.obj
cubewright simplify two.obj -o merged.obj --triangles 800 --merge -q && grep -c '^o' merged.obj
cat >soup.off <<'END2'
OFF
12 4 0
0 0 0
0 9 0
9 0 0
0 0 0
9 0 0
0 0 9
0 0 0
0 0 9
0 9 0
9 0 0
0 9 0
0 0 9
3 0 1 2
3 3 4 5
3 6 7 8
3 9 10 11
END2
cubewright simplify soup.off -o soup.stl --ratio 0.5

# specks are left out, and told
{ cat a.obj; awk -v n="$(grep -c '^v ' a.obj)" 'END { print "v 90 0 0\nv 91 0 0\nv 90 1 0\nf", n + 1, n + 2, n + 3 }' a.obj; } | grep -v ^vn |
    sed 's|//[0-9]*||g' >speck.obj
cubewright simplify speck.obj -o clean.obj --ratio 0.5 --drop-components 2mm --no-measure
cubewright simplify speck.obj -o clean.obj --ratio 0.5 --drop-components 1% --json - -q | grep -e dropped_c -e drop_c -e '"components"'

# a sphere cut in two: each half by itself, and then they still make one
cubewright extract s.nrrd --iso 0 -o whole.off -q
for half in low high; do
    awk -v n="$half" '!/^#/ && NF { line[++k] = $0 } END {
        split(line[2], count)
        for (i = 3; i < 3 + count[1]; i++) { split(line[i], p); z[i - 3] = p[3] }
        for (; i <= k; i++) { split(line[i], c); low = z[c[2]] + z[c[3]] + z[c[4]] < 0
            if (low == (n == "low")) face[++m] = line[i] }
        print "OFF"; print count[1], m, 0
        for (i = 3; i < 3 + count[1]; i++) print line[i]
        for (i = 1; i <= m; i++) print face[i] }' whole.off >half.off
    cubewright simplify half.off -o $half.obj --ratio 0.2 --keep-border -q
done
{ cat low.obj; awk -v n="$(grep -c '^v ' low.obj)" '/^f/ { for (i = 2; i <= 4; i++) $i += n } { print }' high.obj; } >both.obj
cubewright check both.obj --json - -q | grep -e '"components"' -e open_edges

# a flat square, half red, half blue: with a weight the step from one to the other stays
awk 'BEGIN { print "ply\nformat ascii 1.0\nelement vertex 1681\nproperty float x\nproperty float y\nproperty float z"
    print "property uchar red\nproperty uchar green\nproperty uchar blue"
    print "element face 3200\nproperty list uchar uint vertex_indices\nend_header"
    for (y = 0; y <= 40; y++) for (x = 0; x <= 40; x++) print x, y, 0, 255 * (x < 20), 0, 255 * (x > 19)
    for (y = 0; y < 40; y++) for (x = 0; x < 40; x++) { v = 41 * y + x
        print 3, v, v + 1, v + 42; print 3, v, v + 42, v + 41 } }' >halves.ply
mixed() { # the area between both, of 40 at first
    sed '1,/end_header/d' "$1" | awk 'NF > 4 { x[n] = $1; y[n] = $2; red[n++] = $4 > 127 }
        NF == 4 && (red[$2] != red[$3] || red[$2] != red[$4]) {
            sum += ((x[$3] - x[$2]) * (y[$4] - y[$2]) - (x[$4] - x[$2]) * (y[$3] - y[$2])) / 2 }
        END { print (sum < 45 ? "sharp" : "dull") }'
}
cubewright simplify halves.ply -o plain.ply --triangles 150 --no-measure --ascii -q && mixed plain.ply
cubewright simplify halves.ply -o sharp.ply --triangles 150 --attributes color:1 --ascii --json - -q | grep -A2 '"attributes": {' && mixed sharp.ply
