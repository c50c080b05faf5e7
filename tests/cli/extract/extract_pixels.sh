# Only what pictures need: to pixels of cameras, and to a distance from the field.
cubewright version --features | grep -q '^simplify *yes' || { echo "this build does not simplify" >&2; exit 77; }
cubewright make sphere -o s.nrrd --dims 48 -q
cubewright render s.nrrd --iso 0 --mode mesh --backend cpu -o full.png --save-camera cam.json -q
cubewright render s.nrrd --iso 0 --mode mesh --backend cpu -o left.png --camera left --save-camera left.json -q
cubewright extract s.nrrd --iso 0 -o one.ply --camera cam.json --pixel-error 1
cubewright extract s.nrrd --iso 0 -o small.ply --camera cam.json --pixel-error 1 --size 160x90 --shading 180 --max-error 1mm -q
cubewright extract s.nrrd --iso 0 -o three.ply --camera cam.json --pixel-error 1 --size 160x90 --shading 180 --max-error 1mm -q --threads 3 --name small
cmp small.ply three.ply
# of several cameras each is satisfied
cubewright extract s.nrrd --iso 0 -o two.glb --camera cam.json,left.json --pixel-error 0.5 --json - -q |
    sed -n -e '/"cameras"/p' -e '/"pixel_error"/p' -e '/"shading_deg"/p' -e '/"proof"/,/^  }/p'
strings two.glb | grep -o '"simplified":"[^"]*"'
# by the text of a camera; unproven
cubewright extract s.nrrd --iso 0 -o text.ply --camera "$(cat cam.json)" --pixel-error 1 --no-check --name one
cmp one.ply text.ply
# from the full surface, and back: told, proven, and the same for any number of threads
cubewright extract s.nrrd --iso 0 -o near.ply --max-error 0.2mm --json - |
    sed -n -e '/"max_error_mm"/p' -e '/"proof"/,/^  }/p'
cubewright extract s.nrrd --iso 0 -o near3.ply --max-error 0.2mm --threads 3 --no-check --name near
cmp near.ply near3.ply
cubewright extract s.nrrd --iso 0 -o full.ply -q
cubewright check near.ply --reference full.ply --tolerance 0.2mm -q; echo "check: $?"
cubewright extract s.nrrd --iso 0 -o cubic.ply --max-error 0.2mm --placement cubic -q
# what cannot be
bad() { cubewright extract s.nrrd --iso 0 -o bad.ply "$@" || echo "exit $?"; }
bad --pixel-error 1
bad --shading 1
bad --size 10x10
bad --camera cam.json
bad --camera none.json --pixel-error 1
bad --camera cam.json,none.json --pixel-error 1
bad --camera cam.json, --pixel-error 1
bad --camera '{}' --pixel-error 1
bad --camera s.nrrd --pixel-error 1
bad --camera cam.json --pixel-error 0
bad --camera cam.json --pixel-error -1
bad --camera cam.json --pixel-error nan
bad --camera cam.json --pixel-error 1 --size 3
bad --camera cam.json --pixel-error 1 --size 20000x10
bad --camera cam.json --pixel-error 1 --shading 0
bad --camera cam.json --pixel-error 1 --simplify 1mm
bad --camera cam.json --pixel-error 1 --snap 0.3
bad --max-error 1mm --simplify 1mm
ls
