# Text on solids: what is made, what is said of it, and that all of it can be printed.
cat >box.off <<'EOF'
OFF
8 12 0
0 0 0
60 0 0
0 20 0
60 20 0
0 0 40
60 0 40
0 20 40
60 20 40
3 0 2 1
3 1 2 3
3 4 5 6
3 5 7 6
3 0 1 4
3 1 5 4
3 2 6 3
3 3 6 7
3 0 4 2
3 2 4 6
3 1 3 5
3 3 7 5
EOF
cubewright make torus -o torus.nrrd --dims 48 -q
cubewright extract torus.nrrd --iso 0 -o torus.stl -q
cubewright engrave box.off --text 'L 4711' -o flat.off
cubewright engrave box.off --text '{stem} 5%' --size 5mm --depth 0.6mm --direction 0,0,1 --emboss -o raised.off
cubewright engrave torus.stl --text Ring --at 0,-40,0 --size 4mm -o ring.off
cubewright engrave box.off --text 20°C --at 30,0,20 --direction 0.2,-1,0 --size 4mm --stroke 0.5mm --wall 3mm -o slanted.off
for f in flat raised ring slanted; do
    cubewright check $f.off --profile print -q && echo "$f can be printed"
done
for t in 1 3; do
    cubewright engrave torus.stl --text same -t $t -o t$t.off --name ring -q
done
cmp t1.off t3.off && echo "same"

# each part has its name
cubewright boolean box.off ring.off --op split -o parts.3mf -q
cubewright engrave parts.3mf --text '{name}' -o named.3mf 2>&1 | grep letters
cubewright engrave parts.3mf --text A --at 0,0,0 -o x.3mf -q
echo $?

# while a surface is extracted, then simplified
cubewright extract torus.nrrd --iso 0 --engrave 'L 4711' --simplify 0.1mm -o simple.stl
cubewright check simple.stl --profile print -q && echo "the surface can be printed"
cubewright engrave box.off --text 'L 4711' -o x.off --json - -q | sed -n -e '/"engraved"/,/^  ],/p' -e '/"params"/,/}/p'
