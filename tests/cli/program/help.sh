# Every command has a short help, and a long one: a page with examples that a terminal can show.
cubewright
cubewright --version
cubewright help exit
cubewright help environment >page && grep -q NO_COLOR page || echo "no page on the environment"
cubewright help library >page && grep -q pkg-config page || echo "no page on the library"
awk 'length > 96 { print "library: a long line: " $0 }' page
for c in extract simplify smooth remesh repair convert hollow offset info render report view make formats help version; do
    cubewright $c -h >short || exit
    cubewright help $c >long || exit
    grep -q -e '--quiet' short && grep -q "^cubewright $c" long || echo "$c lacks its help"
    grep -A1 '^Examples$' long | grep -q "^  cubewright $c" || echo "$c has no examples"
    sed '/^Options/,$d' long | awk -v c="$c" 'length > 96 { print c ": a long line: " $0 }'
done
