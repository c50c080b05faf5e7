# Solids are united, subtracted, intersected; contacts, several inputs, a report, parts.
cube() { # NAME X Y Z SIZE
    awk -v n="$1" -v x="$2" -v y="$3" -v z="$4" -v s="$5" 'BEGIN {
        for (v = 0; v < 8; v++)
            printf "v %g %g %g\n", x + s * int(v / 4), y + s * int(v / 2 % 2), z + s * (v % 2)
        print "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4" }' >"$1"
}
volume() { # NAME: of the report that is read
    awk -v n="$1" '/"volume":/ {printf "%s %.6g\n", n, $2}'
}
cube a.obj 0 0 0 4
cube b.obj 2 2 2 4
cube c.obj 3 3 3 4
cube face.obj 4 1 1 2
cube edge.obj 4 4 0 4
cube far.obj 9 9 9 4
for op in union difference intersection xor; do
    cubewright boolean a.obj b.obj --op $op -o $op.stl --json - -q | volume $op
done
cubewright boolean a.obj b.obj c.obj --op intersection -o three.obj --json - -q | volume three
cubewright boolean a.obj face.obj -o face.ply -q
cubewright boolean a.obj edge.obj -o edge.ply
cubewright boolean a.obj b.obj --op split -o split.obj -q && grep '^o ' split.obj
cubewright boolean a.obj far.obj --op split -o one.obj -q
# one mesh of two shells becomes one shell
cat a.obj >two.obj && sed '/^f/d' b.obj >>two.obj && sed -n '/^f/p' b.obj | awk '{print "f", $2 + 8, $3 + 8, $4 + 8, $5 + 8}' >>two.obj
cubewright boolean two.obj -o united.stl -q
cmp union.stl united.stl || cubewright check union.stl united.stl -q
cubewright boolean a.obj b.obj --op difference --threads 4 -o threads.stl -q && cmp difference.stl threads.stl && echo same
cubewright boolean a.obj b.obj --op difference -o d.stl --json - -q | sed -n '/"boolean": {/,/}/p'
# STL cannot hold doubled vertices, and the line tells
cubewright boolean a.obj edge.obj -o edge.stl 2>/dev/null
