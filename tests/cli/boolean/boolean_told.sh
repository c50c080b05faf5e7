# Told by name: files that are inside out, empty, or have a shell that is; edges that are not those of a solid.
cat >box.obj <<'X'
v 0 0 0
v 4 0 0
v 0 4 0
v 4 4 0
v 0 0 4
v 4 0 4
v 0 4 4
v 4 4 4
f 1 3 4
f 1 4 2
f 5 6 8
f 5 8 7
f 1 2 6
f 1 6 5
f 3 7 8
f 3 8 4
f 1 5 7
f 1 7 3
f 2 4 8
f 2 8 6
X
awk '/^f/ {print $1, $2, $4, $3; next} 1' box.obj >turned.obj
awk '/^v/ {print $1, $2 + 1, $3 + 1, $4 + 1; next} 1' turned.obj >turned2.obj
awk '/^v/ {print $1, $2 * 0, $3, $4 * 0; next} 1' box.obj >flat.obj
printf 'solid\nendsolid\n' >none.stl
# beside the box, and in the other one's cavity: the first is lost, the second is none
{ cat box.obj; awk '/^v/ {print $1, $2 / 2 + 9, $3 / 2, $4 / 2; next} {print $1, $2 + 8, $4 + 8, $3 + 8}' box.obj; } >beside.obj
{ cat box.obj; awk '/^v/ {print $1, $2 / 2 + 1, $3 / 2 + 1, $4 / 2 + 1; next} {print $1, $2 + 8, $4 + 8, $3 + 8}' box.obj; } >cavity.obj
sed 's/^f 1 3 4$/f 1 4 3/' box.obj >flipped.obj
{ cat box.obj; echo 'f 1 3 4'; } >twice.obj
{ cat box.obj; echo 'f 1 4 3'; } >odd.obj
told() {
    cubewright boolean "$@" -o out.ply 2>&1 >/dev/null | grep -v 'no unit given' || true
}
told box.obj turned.obj
told turned.obj turned2.obj
told turned.obj turned2.obj turned.obj turned2.obj
told box.obj flat.obj
told none.stl box.obj
told beside.obj
told beside.obj --op intersection box.obj
told cavity.obj
told box.obj flipped.obj
told box.obj twice.obj
told box.obj odd.obj
cubewright boolean beside.obj -o out.ply --json - -q | sed -n '/"turned/p; /"empty/p; /"negative/p'
cubewright convert beside.obj --orient -o right.obj -q && told right.obj
