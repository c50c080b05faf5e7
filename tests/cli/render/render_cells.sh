# Cells drawn by the CPU, without OpenGL: the same picture for any number of threads.
cubewright make torus -o t.nrrd --dims 24 -q
draw() {
    cubewright render t.nrrd --mode projection --backend cpu --size 70x50 --tf fog -q "$@"
}
draw -o one.png -t 1
draw -o three.png -t 3
cmp one.png three.png && echo "same"
for setting in --no-lit --linear-opacity '--stop-opacity 0.2' '--clip 0,0,1,0' --ortho \
    '--depth-cue 1' --no-preintegration; do
    draw -o s.png $setting || echo "exit $?"
    cmp -s s.png one.png && echo "$setting changes nothing"
done
cubewright render t.nrrd --mode projection --backend cpu --size 70x50 -o t.png
