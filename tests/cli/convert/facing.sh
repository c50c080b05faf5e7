# Closed meshes that are inside out, as a whole or in part; and bounds that leave little.
cat >in.off <<'END'
OFF
4 4 0
0 0 0
1 0 0
0 1 0
0 0 1
3 0 1 2
3 0 3 1
3 0 2 3
3 1 3 2
END
line() {
    sed -E 's/^[^:]*: //;s/; box.*//'
}
cubewright convert in.off -o out.stl | line
cubewright convert in.off -o out.stl --orient --json r.json | line
grep -e '"orient"' -e '"facing_wrong"' -e '"volume"' r.json
cubewright convert out.stl -o again.off -q --json - | grep '"facing_wrong"'
cubewright simplify in.off -o s.ply --ratio 0.9 | line
cubewright simplify in.off -o s.ply --ratio 0.9 --orient -q --json - | grep '"facing_wrong"'
# a solid and its cavity, both turned round; and only the cavity
cubewright make sphere -o s.nrrd --dims 16 -q
cubewright extract s.nrrd --iso 0 -o big.off --normals none -q
cubewright extract s.nrrd --iso 15 -o small.off --normals none -q
# join FIRST SECOND: one mesh of two, each with + or - for whether it is turned round
join() {
    awk -v turn="$3" 'FNR == 1 { file++; first = vertices; next } /^#/ || NF == 0 { next }
        !(file in v) { v[file] = $1; f[file] = $2; next }
        NF == 3 { point[vertices++] = $0; next }
        { s = substr(turn, file, 1) == "-"; face[faces++] = "3 " $2 + first " " (s ? $4 : $3) + first " " (s ? $3 : $4) + first }
        END { print "OFF\n" vertices, faces, 0; for (n = 0; n < vertices; n++) print point[n]
            for (n = 0; n < faces; n++) print face[n] }' "$1" "$2"
}
for turn in +- -+ -- ++; do
    join big.off small.off "$turn" >both.off
    echo "$turn"
    cubewright convert both.off -o x.ply -q --json - | grep -e '"facing_wrong"'
    cubewright convert both.off -o x.ply | line
    cubewright convert both.off -o x.ply --orient | line
    cubewright check x.ply | grep -e outward -e volume | sed 's/.*, volume/volume/'
done 2>/dev/null
# split vertices do not hide it, and an open shell is left alone
cubewright convert in.off -o split.ply --ascii -q
awk 'NR == 1 { print "OFF\n12 4 0"; next } NR > 2 && NF == 3 { p[n++] = $0 } NF == 4 { for (c = 2; c <= 4; c++) print p[$c]; t++ }
    END { for (k = 0; k < t; k++) print 3, 3 * k, 3 * k + 1, 3 * k + 2 }' in.off >split.off
cubewright convert split.off -o x.ply | line
cubewright convert split.off -o x.ply --orient | line
sed 's/^4 4/4 3/;$d' in.off >open.off
cubewright convert open.off -o x.ply --orient | line

for error in 10mm 7% 4%; do
    cubewright simplify big.off -o x.ply --error $error 2>&1 >y | grep -e diagonal || echo "no word of $error"
    cubewright simplify big.off -o x.ply --error $error --force 2>&1 >y | grep -e diagonal
done
sed 2,3d big.off >bare.off
cubewright simplify bare.off -o x.ply --error 10mm --json r.json 2>&1 >y
sed -n '/"exit"/p' r.json
