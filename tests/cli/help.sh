# Every command has a short and a long help, and says which options it takes.
cubewright
cubewright --version
cubewright help exit
for c in extract simplify convert hollow offset info render report bench view make formats help version; do
    cubewright $c -h >short || exit
    cubewright help $c >long || exit
    grep -q -e '--quiet' short && grep -q "^cubewright $c" long || echo "$c lacks its help"
done
cubewright help --search isovalue
