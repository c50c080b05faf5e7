# A camera and a transfer function as text: what their files hold, so that a command says all.
cubewright make torus -o t.nrrd --dims 16 -q
draw() {
    cubewright render t.nrrd --mode mip --backend cpu --size 48x32 -q "$@"
}
draw -o a.png --camera 30,20 --zoom 1.5 --tf fog --shift 2 --save-camera eye.json --save-tf tf.json
draw -o b.png --camera "$(cat eye.json)" --tf "$(cat tf.json)" --save-camera eye2.json --save-tf tf2.json
cmp a.png b.png && cmp eye.json eye2.json && cmp tf.json tf2.json && echo "same"
draw -o c.png --camera 30,20 --tf "$(cat tf.json)"
cmp -s a.png c.png || echo "another"
draw -o 'f-{turn}.png' --camera eye.json --tf fog --turntable 3
draw -o 't-{turn}.png' --camera "$(cat eye.json)" --tf fog --turntable 3
cmp f-1.png t-1.png && cmp f-2.png t-2.png && echo "same"
cubewright render t.nrrd --mode mip --backend cpu --size 48x32 -o d.png --camera "$(cat eye.json)"

# What is wrong with a text is told, and of which option.
try() {
    draw -o x.png "$@"
    echo "$?"
}
try --camera '{'
try --camera '{"schema": "cubewright-camera-1", "eye": [0, 0]}'
try --camera '{"schema": "cubewright-transfer-1"}'
try --camera "$(cat eye.json)" --ortho
try --camera "$(cat eye.json)" --fov 20
try --tf '{"schema": "cubewright-transfer-1", "opacities": [[0, 2]]}'
try --tf '{"schema": "cubewright-transfer-1", "opacity": []}'
try --tf '{"schema": "cubewright-transfer-1"} x.json'
test -e x.png || echo "nothing was drawn"
