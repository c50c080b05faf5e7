# What is wrong with the window's commands is said; the exit code tells, too.
cubewright version --features | grep -q '^window *yes' || { echo "this build has no window" >&2; exit 77; }
cubewright version --features | grep -q '^gl *yes' || { echo "this build has no OpenGL" >&2; exit 77; }
cubewright make ct-head -o h.nrrd --dims 16 --type i16 -q
view() {
    cubewright view h.nrrd -q --hidden --size 400x80 --exec "$*" || echo "exit $?"
}

# Files of commands, comments, quotes, colours.
printf '# a comment\nmode mip; print mode # another\n\n  print "layout"\nrun more.txt\r\n' >run.txt
printf 'print lit\n' >more.txt
view 'run run.txt; color-point 0 #ff8000; print tf; orbit 3 # and so on; on'
printf 'run loop.txt\n' >loop.txt
view 'run loop.txt'
for wrong in 'bogus 3' 'iso-bt 3' 'lith off' 'orbit abc' 'orbit nan' 'orbit 1 2 3' orbit "screenshot 'a" 'run none.txt' 'open none.nrrd' \
    'lit maybe' 'mode fish' 'samples 9' 'iso x' 'camera up' 'hidden on' 'toggle fish' 'toggle help maybe' 'print fish' 'key Fish' \
    'click Fish' 'resize 0 3' 'step 1' undo redo 'turntable 1 a{turn}.png' 'turntable 2 a.png' 'clip-face 6 1' 'cut w 1' 'window 2 1' \
    'split 2' 'point 99 1 1' 'color-point 0 mauve' 'wheel-cuts q' 'monkey 1 -1' 'run h.nrrd' 'screenshot a.jpg' 'capture a' \
    'turntable 2 {turn}' 'compare mip' next 'screenshot none/a.png' 'a b c d e f g h i j k l m n o p q'; do
    view "$wrong"
done
cubewright view -q --hidden --exec 'screenshot a.png' || echo "exit $?"
cubewright view -q -o a.png || echo "exit $?"
cubewright view h.nrrd -q -o a.jpg || echo "exit $?"
cubewright view h.nrrd -q --hidden --size 10 || echo "exit $?"
cubewright view h.nrrd -q --hidden --run none.txt || echo "exit $?"
cubewright view -q --hidden --exec 'iso 3; lit off; mode mip; orbit 3' || echo "exit $?"
find . -name '*.png' -o -name '*.jpg'
