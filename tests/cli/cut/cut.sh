# A block is cut to pieces: parts and files, several planes, pegs and dowels, plates, lying, a picture, a report.
box() { # NAME X Y Z
    awk -v x="$2" -v y="$3" -v z="$4" 'BEGIN {
        for (v = 0; v < 8; v++)
            printf "v %g %g %g\n", x * int(v / 4), y * int(v / 2 % 2), z * (v % 2)
        print "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4" }' >"$1"
}
box box.obj 40 30 60
cubewright cut box.obj --plane z=50% -o two.obj && grep '^o ' two.obj
cubewright cut box.obj --plane z=25mm,x=10mm,0,0,10:0,0.2,1 -o many.obj -q && grep -c '^o ' many.obj
cubewright cut box.obj --plane z=25mm --pegs 2 --peg-diameter 6mm --peg-length 10mm --clearance 0.25mm \
    -o '{stem}-{name}.stl' --json facts.json
ls ./*.stl
sed -n '/"cut": {/,/"sections"/p' facts.json | grep -e mm3 -e name -e pegs -e holes
cubewright cut box.obj --plane z=25mm --pegs 2 --peg-kind dowel -o dowels.obj -q && grep '^o ' dowels.obj
cubewright cut box.obj --plate 35x35x35mm --pegs 1 --lay -o laid.3mf
cubewright cut box.obj --plate 100x100x100mm -o whole.obj -q && grep '^o ' whole.obj
# without an output there is a picture alone
cubewright cut box.obj --plane z=25mm --pegs 2 --preview look.png
[ "$(head -c 4 look.png | tail -c 3)" = PNG ] && echo picture
# the bytes do not depend on threads
for n in 1 4; do
    cubewright cut box.obj --plane 0,0,25:0.1,0,1 --pegs 3 -o $n.obj --preview $n.png --threads $n -q
done
cmp 1.obj 4.obj && cmp 1.png 4.png && echo same
for n in 1 2; do
    cubewright check box-piece-$n.stl --profile print -q || echo "piece $n"
done
