# What no camera sees is left out; the pictures are the same.
cubewright make sphere -o s.nrrd --dims 48 -q
cubewright render s.nrrd --iso 0 --mode mesh --backend cpu -o a.png --size 320x200 --save-camera cam.json -q
cubewright extract s.nrrd --iso 0 -o seen.ply --camera cam.json --cull --size 320x200
cubewright extract s.nrrd --iso 0 -o three.ply --camera cam.json --cull --size 320x200 --threads 3 --no-check -q --name seen
cmp seen.ply three.ply
# the half that faces the camera, and not much more
cubewright check seen.ply | grep -o '^seen.ply: 1 component'
cubewright render seen.ply --mode mesh --backend cpu -o b.png --size 320x200 --camera cam.json -q
cubewright extract s.nrrd --iso 0 -o full.ply -q
cubewright render full.ply --mode mesh --backend cpu -o c.png --size 320x200 --camera cam.json -q
cmp b.png c.png && echo "same picture"
# near, only a part of the volume is looked at
near='{"schema": "cubewright-camera-1", "eye": [0, -80, 0], "target": [15, 0, 10], "up": [0, 0, 1], "fov_deg": 8}'
cubewright extract s.nrrd --iso 0 -o near.ply --camera "$near" --cull --size 320x200 --json - -q | sed -n -e '/"cull"/p' -e '/"proof"/,/^  }/p'
cubewright extract s.nrrd --iso 0 -o large.ply --camera "$near" --cull --size 320x200 --min-volume 1ml
# all that is asked for of cameras, at once
if cubewright version --features | grep -q '^simplify *yes'; then
    cubewright extract s.nrrd --iso 0 -o few.ply --camera cam.json --cull --pixel-error 0.5 --size 320x200 2>&1 |
        grep -o 'at most 0.* pixels off, 0.5 promised'
fi
# what cannot be
bad() { cubewright extract s.nrrd --iso 0 -o bad.ply "$@" || echo "exit $?"; }
bad --cull
bad --camera cam.json --cull --shading 2
bad --camera cam.json --cull --max-error 1mm
bad --camera cam.json --cull --snap 0.3
bad --camera '{"schema": "cubewright-camera-1", "eye": [0, -80, 0], "target": [0, -90, 0], "up": [0, 0, 1], "fov_deg": 8}' --cull -q
bad --camera '{"schema": "cubewright-camera-1", "eye": [0, -80, 0], "target": [38, 0, 38], "up": [0, 0, 1], "fov_deg": 1}' --cull -q
ls *.ply
