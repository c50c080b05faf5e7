# An STL that breaks off is refused, with a way on: binary or text. What is left of the ball is closed again.
cubewright make sphere -o ball.nrrd --dims 16 -q
cubewright extract ball.nrrd --iso 0 -o ball.stl -q
printf 'solid x' | cat - ball.stl | tail -c +8 >named.stl # its header begins as a text does
size=$(wc -c <ball.stl)
head -c $((size - 420)) ball.stl >cut.stl
head -c $((size - 420)) named.stl >named_cut.stl
cubewright check cut.stl
echo "exit $?"
for name in cut named_cut; do
    cubewright repair $name.stl -o solid.stl
    echo "exit $?"
    cubewright repair $name.stl --truncated -o solid.stl --json solid.json -q
    echo "exit $?"
    awk '/"truncated"|"expected_triangles"/ { print $1, $2 }' solid.json
    cubewright check solid.stl --profile print -q && echo sound
done
cubewright convert cut.stl --truncated -o cut.off

awk 'BEGIN {
    print "solid tip"
    split("0 0 0,0 9 0,9 0 0,0 0 0,9 0 0,0 0 9,0 0 0,0 0 9,0 9 0,9 0 0,0 9 0,0 0 9", p, ",")
    for (i = 1; i <= 12; i += 3)
        print "facet normal 0 0 0\nouter loop\nvertex", p[i] "\nvertex", p[i + 1] "\nvertex", p[i + 2] "\nendloop\nendfacet"
    print "endsolid tip"
}' | head -n 25 >text.stl
cubewright repair text.stl -o solid.stl
echo "exit $?"
cubewright repair text.stl --truncated -o solid.stl -q
cubewright check solid.stl -q && echo sound
