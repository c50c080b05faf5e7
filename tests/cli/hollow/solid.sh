# A solid with a wall, and the surface at a distance: what is made, and what is said of it.
cubewright version --features | grep -q '^level-set *yes' || { echo "this build has no OpenVDB" >&2; exit 77; }
cubewright make sphere -o s.nrrd --dims 32 -q
cubewright extract s.nrrd --iso 0 -o s.off -q
cubewright hollow s.off -o h.off --wall 3mm
# the outer surface is what it was: its vertices and its triangles stand first
points() { grep -v '^#' "$1" | sed -n "3,$((2 + $2))p"; }
points s.off 2592 >a && points h.off 2592 >b && cmp a b && echo "same outside"
cubewright hollow s.off -o one.stl --wall 3mm --drain 6mm@-z --voxel 1mm -q
cubewright hollow s.off -o two.ply --wall 3mm --drain 10%@x,6mm@-y --voxel 1mm --no-measure
cubewright check one.stl --json - -q | grep -e '"components"' -e '"euler"' -e open_edges
cubewright check two.ply --json - -q | grep -e '"components"' -e '"euler"' -e open_edges
cubewright offset s.off -o more.stl --by 2mm --voxel 1mm
cubewright offset s.off -o less.stl --by -2mm --voxel 1% -q
cubewright offset s.off -o same.stl --by 0 --voxel 1mm
cubewright offset s.off -o '{stem}-auto.stl' --by=-5% --no-measure
for t in 1 3; do
    cubewright hollow s.off -o t$t.glb --wall 4mm --drain 5mm@+x -t $t --name t -q
done
cmp t1.glb t3.glb && echo "same"

# the reports
cubewright hollow s.off -o h.stl --wall 3mm --drain 6mm@-z --voxel 1mm --json - -q |
    sed -n -e '/"hollow": {/,/}/p' -e '/"params"/,/"voxel_mm"/p'
cubewright offset s.off -o o.stl --by -2mm --voxel 1mm --json - -q |
    sed -n -e '/"off": {/,/}/p' -e '/"params"/,/"voxel_mm"/p'

# a groove that voxels of 6 mm do not see
cat >g.off <<'EOF'
OFF
14 24 0
-10 0 0
10 0 0
10 12 0
2.14359354 12 0
0 4 0
-2.14359354 12 0
-10 12 0
-10 0 14
10 0 14
10 12 14
2.14359354 12 14
0 4 14
-2.14359354 12 14
-10 12 14
3 0 1 8
3 0 8 7
3 1 2 9
3 1 9 8
3 2 3 10
3 2 10 9
3 3 4 11
3 3 11 10
3 4 5 12
3 4 12 11
3 5 6 13
3 5 13 12
3 6 0 7
3 6 7 13
3 0 4 1
3 7 8 11
3 1 3 2
3 8 9 10
3 1 4 3
3 8 10 11
3 0 5 4
3 7 11 12
3 0 6 5
3 7 12 13
EOF
cubewright offset g.off -o g.stl --by 0 --voxel 6mm --json g.json | sed 's/; at most.*//'
grep -e '"voxel' g.json
cubewright offset g.off -o g.stl --by 0 --voxel 6mm --no-refine --json g.json | sed 's/; at most.*//'
grep -e '"exit"' -e '"status"' g.json
cubewright make hard/noise -d 8 -o n.nrrd
cubewright extract n.nrrd --iso 0 -o n.ply -q
cubewright offset n.ply -o n.glb --by 0 --voxel 1.7mm --json n.json | sed 's/; at most.*//'
sed -n '/"anew"/,/}/p' n.json
cubewright make sphere -d 12 -o ball.nrrd -q
cubewright extract ball.nrrd --iso 0 -o ball.off -q
two() { # the ball and a copy of it, moved and perhaps turned inside out
    grep -v '#' ball.off | awk -v by="$1" -v turn="$2" '
        NR == 2 { v = $1; t = $2; print "OFF"; print 2 * v, 2 * t, 0 }
        NR > 2 { line[NR] = $0 }
        END {
            for (copy = 0; copy < 2; copy++)
                for (n = 3; n < 3 + v; n++) {
                    split(line[n], x, " ")
                    print x[1] + copy * by, x[2], x[3]
                }
            for (copy = 0; copy < 2; copy++)
                for (n = 3 + v; n < 3 + v + t; n++) {
                    split(line[n], c, " ")
                    if (copy && turn) { k = c[2]; c[2] = c[3]; c[3] = k }
                    print 3, c[2] + copy * v, c[3] + copy * v, c[4] + copy * v
                }
        }'
}
two 4 0 >two.off
cubewright hollow two.off --wall 4mm -o shell.obj | sed 's/; box.*//'
cubewright check shell.obj --profile print | grep -e self -e profile | sed 's/;.*//'
two 4 1 >turned.off
cubewright hollow turned.off --wall 4mm -o turned.obj -q || echo "exit $?"
