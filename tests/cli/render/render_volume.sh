# Volumes in pictures: by ray casting, from cameras of any kind, turning, and step by step.
cubewright version --features | grep -q '^gl *yes' || { echo "this build has no OpenGL" >&2; exit 77; }
cubewright make torus -o t.nrrd --dims 24 -q
cubewright render t.nrrd -o t.png --size 80x60
od -A n -t u1 -j 16 -N 8 t.png

# Without a table that is integrated first, small pictures are there at once; of a narrow function it
# makes another picture.
draw() {
    cubewright render "$@" --no-preintegration -q
}

# What is saved gives the same picture again; angles are views, and so are turns.
draw t.nrrd -o a.png --size 64x64 --save-tf tf.json --save-camera front.json
draw t.nrrd -o b.png --size 64x64 --tf tf.json --camera front.json
draw t.nrrd -o c.png --size 64x64 --camera 0,0
draw t.nrrd -o d.png --size 64x64 --shift 5 --save-tf up.json
draw t.nrrd -o e.png --size 64x64 --tf up.json --shift -5
cmp a.png b.png && cmp a.png c.png && cmp a.png e.png && echo "same"
cmp -s a.png d.png || echo "another"
grep -c schema front.json tf.json
draw t.nrrd -o 'turn-{turn:02d}.png' --size 64x64 --turntable 4
draw t.nrrd -o left.png --size 64x64 --camera left
draw t.nrrd -o 'arc-{turn}.png' --size 64x64 --turntable 3 --orbit 180
cmp turn-00.png arc-0.png && cmp turn-01.png arc-1.png && cmp turn-02.png arc-2.png && echo "same"
narrow='{"schema": "cubewright-transfer-1", "opacities": [[-9, 0], [-0.5, 0], [0, 1], [0.5, 0], [9, 0]]}'
draw t.nrrd -o sampled.png --size 64x64 --tf "$narrow"
cubewright render t.nrrd -o i.png --size 64x64 -q --tf "$narrow"
cmp -s i.png sampled.png || echo "another"
ls turn-*.png arc-*.png | wc -l

# Nothing of it left, in part or at all; as one box of voxels or of millimetres.
draw t.nrrd -o low.png --size 64x64 --clip-box 0:23,0:23,0:11.5
draw t.nrrd -o high.png --size 64x64 --clip 0,0,1,0
draw t.nrrd -o away.png --size 64x64 --clip 0,0,1,0 --cut-away
draw t.nrrd -o mm.png --size 64x64 --clip-box -100mm:100mm,-100mm:100mm,-100mm:0mm
draw t.nrrd -o two.png --size 64x64 --clip '0,0,-2,0;0,0,1,-200'
cmp low.png away.png && cmp low.png mm.png && cmp low.png two.png && echo "same"
draw t.nrrd -o ten.png --size 64x64 --clip 0,0,1,10
draw t.nrrd -o long.png --size 64x64 --clip 0,0,5,50
cmp ten.png long.png && echo "same"
cmp -s ten.png high.png && echo "no other"
cmp -s low.png high.png || echo "another"
draw t.nrrd -o none.png --size 64x64 --clip 0,0,1,999 --background '#102030'
cubewright render t.nrrd -o thin.png --size 64x64 --opacity 0 --background 102030 --no-preintegration
cmp none.png thin.png && echo "same"

# A colour's last two digits are its opacity.
cubewright extract t.nrrd --iso 0 -o t.ply -q
for opacity in ff 80 40; do
    cubewright render t.ply -o $opacity.png --size 64x64 --color "#e6dec1$opacity" -q
done
cmp -s ff.png 80.png || cmp -s 80.png 40.png || echo "another"

# Settings that change the picture, one by one.
for setting in --no-lit '--lambert one-sided --light 1,0,-0.5' '--light 1,1,0' '--ambient 0.9' '--diffuse 0.1' '--specular 1' '--shininess 2' \
    '--depth-cue 1' '--depth-cue 0.5' '--background white' '--tf fog' '--opacity 0.1' '--step-length 5' --cell-steps \
    --ortho '--fov 60' '--zoom 2' '--samples 3' '--stop-opacity 0.5' '--light 0,0,1,1,0,0'; do
    draw t.nrrd -o s.png --size 64x64 $setting || echo "exit $?"
    cmp -s s.png a.png && echo "$setting changes nothing"
done
draw t.nrrd -o cue.png --size 64x64 --depth-cue 0.5
for setting in '--depth-cue-range 0.2,0.7' '--depth-cue-form exponential'; do
    draw t.nrrd -o s.png --size 64x64 --depth-cue 0.5 $setting
    cmp -s s.png cue.png && echo "$setting changes nothing"
done
draw t.nrrd -o s.png --size 64x64 --depth-cue 0.5 --depth-cue-range 0,1 --depth-cue-form linear
cmp s.png cue.png
draw t.nrrd -o s.png --size 64x64 --light 1,1,0 --jitter
# Slices are spread from the first to the last voxel: 23 steps of a voxel in 40 parts.
draw t.nrrd -o s.png --size 8x8 --mode texture --ortho --slices 40 --json - | grep '"step_length"'
draw t.nrrd -o s.png --size 64x64 --exact-filter --no-skipping --texture-edge 16

# Steps of a series: one transfer function and one camera for all.
sh "$TESTS/support/steps.sh" 16 >4d.nrrd
cubewright render 4d.nrrd --steps 0:2 -o 's-{step:02d}.png' --size 32x32 --json r.json --no-preintegration
grep -e '"schema"' -e '"mode"' -e '"source"' -e '"path"' -e '"step"' -e '"status"' r.json
cubewright render 4d.nrrd --step 2 -o one.png --size 32x32 --json - -q --no-preintegration | grep -c '"backend": "OpenGL'
draw t.nrrd 4d.nrrd -o x.png || echo "exit $?"

# Numbers that are no Hounsfield units, and nothing to be seen, are told.
cubewright render t.nrrd -o s.png --tf ct-bone --size 32x32 --no-preintegration
cubewright make ct-head -o ct.nrrd --dims 24 -q
cubewright render ct.nrrd -o s.png --tf ct-bone --size 32x32 --no-preintegration
