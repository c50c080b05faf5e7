# Refused: open meshes, results that are empty, outputs that are inputs, two parts in a format without parts.
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n' >t.obj
sed '$d' t.obj >open.obj
awk '/^v/ {print $1, $2 + 1, $3, $4; next} 1' t.obj >touch.obj
try() {
    cubewright boolean "$@" -q
    echo "exit $?"
}
try t.obj
try -o out.obj
try t.obj open.obj -o out.obj
try t.obj touch.obj --op intersection -o out.obj
try t.obj t.obj --op difference -o out.obj
try t.obj touch.obj --op split -o out.stl
try t.obj touch.obj -o touch.obj
try t.obj missing.obj -o out.obj
try t.obj touch.obj --op cut -o out.obj
ls out.* 2>/dev/null || true
