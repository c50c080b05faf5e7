# Materials by a file, by text and by presets; what the options change, and a saved function that
# repeats the picture. On the CPU: no OpenGL is needed.
cubewright make torus -o t.nrrd --dims 24 -q
cat >m.json <<'END'
{"schema": "cubewright-transfer-1", "gradients": [[0, 0.2], [1, 1]],
 "materials": [{"name": "air", "values": [null, null, -0.2, 0], "color": "#000000"},
  {"name": "rim", "values": [-0.2, 0, 0.1, 0.2], "color": "#3366cc", "opacity": 0.1, "index": 1},
  {"values": [0.1, 0.2, null, null], "color": "#ffcc33", "opacity": 0.9, "index": 3}]}
END
draw() {
    cubewright render t.nrrd --size 48x36 --mode vbuffer -q "$@" || echo "exit $?"
}
draw --tf m.json --save-tf saved.json -o file.png
draw --tf "$(cat m.json)" -o text.png
draw --tf saved.json -o saved.png
cmp file.png text.png && cmp file.png saved.png && echo "same"
draw --tf m.json --surface-width 40 -o wide.png
draw --tf m.json --gradient-opacity 0:1 -o even.png
draw --tf m.json --gradient-smoothing 2 -o smooth.png
draw --tf m.json --shift 0.05 -o shifted.png
draw --tf m.json --shadow light --light 1,0,0 -o dark.png
draw --tf m.json --shadow ambient -o occluded.png
for other in wide even smooth shifted dark occluded; do
    cmp -s file.png $other.png && echo "$other is the same"
done
for preset in ct-materials mr-materials metals; do
    draw --tf $preset --save-tf p.json -o p.png 2>/dev/null
    grep -c '"indices"' p.json
done
draw --tf fog --surface-width 2 -o x.png
draw --tf m.json --surface-width -1 -o x.png
draw --tf m.json --gradient-opacity 0-1 -o x.png
draw --tf m.json --gradient-opacity 1:0,0:1 -o x.png
draw --tf m.json --gradient-smoothing 17 -o x.png
draw --tf '{"schema": "cubewright-transfer-1", "materials": [{"values": [3, 2, 1, 0], "color": "#ffffff"}]}' -o x.png
cubewright render t.nrrd --size 48x36 --mode mip --gradient-smoothing 1 -q -o x.png
cubewright render t.nrrd --size 48x36 --mode projection --shadow light -q -o x.png
ls x.png 2>/dev/null
