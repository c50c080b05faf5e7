# Refused: no plane, one that misses, pegs without room, open meshes, outputs that cannot hold pieces.
printf 'v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n' >t.obj
sed '$d' t.obj >open.obj
try() {
    cubewright cut "$@" -q
    echo "exit $?"
}
try t.obj
try t.obj -o out.obj
try t.obj --plane z=2mm
try t.obj --plane z=12mm -o out.obj
try t.obj --plane z=2 -o out.obj
try t.obj --plane 0,0,1:0,0,0 -o out.obj
try t.obj --plane z=2mm -o out.stl
try t.obj --plane z=2mm -o t.obj
try t.obj --plane z=2mm --preview t.obj
try t.obj --plane z=2mm --preview out.obj -o out.obj
try t.obj --plane z=2mm --pegs 1 --peg-diameter 9mm -o out.obj
try t.obj --plane z=2mm --pegs 1 --clearance 5mm -o out.obj
try t.obj --plane z=2mm --pegs 1 --clearance 0mm -o out.obj
try t.obj --plane z=2mm --wall 1mm -o out.obj
try t.obj --plate 0.01x1x1mm -o out.obj
try t.obj --plane z=2mm --plate 20x20x3mm --lay -o out.obj
try open.obj --plane z=2mm -o out.obj
ls out.* 2>/dev/null || true
