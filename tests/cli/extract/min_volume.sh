# Components that enclose little are left out, with what is in them; before anything else.
cubewright make hard/lone-samples -o lone.nrrd --dims 12 -q
cubewright make ct-head -o ct.nrrd -q
cubewright extract ct.nrrd --iso 300 -o all.ply --normals none -q
cubewright extract ct.nrrd --iso 300 -o small.ply --normals none --min-volume 1e-9mm3 -q --name all
cmp all.ply small.ply && echo same
cubewright extract ct.nrrd --iso 300 -o one.ply --min-volume 500ml --json - | sed -n -e '/"min_volume_mm3"/p' -e '/"components_dropped"/,/}/p'
# the same volume in other units
for volume in 5e14um3 500cm3 500000mm3 0.0005m3; do
    cubewright extract ct.nrrd --iso 300 -o unit.ply --normals none --no-check --min-volume $volume --json - -q |
        sed -n 's/.*"min_volume_mm3": //p'
done
rm unit.ply
cubewright check one.ply | grep -o '^one.ply: 1 component'
# what was left out is told apart from how far the rest is; in the comparison it can be left out, too
cubewright check one.ply --source ct.nrrd --iso 300 | grep -A 1 -e missing -e covered | sed 's/, rms.*//'
cubewright check one.ply --source ct.nrrd --iso 300 --tolerance 1mm 2>e | grep FAIL | sed 's/;.*//'
cubewright check one.ply --source ct.nrrd --iso 300 --json - -q | sed -n '/"missing": {/,/}/p'
cubewright check one.ply --source ct.nrrd --iso 300 --min-volume 500ml --tolerance 1mm | grep -e topology -e missing -e covered | sed 's/, rms.*//'
cubewright check one.ply --min-volume 500ml || echo "exit $?"
# the full surface that simplification is held against is what was kept
if cubewright version --features | grep -q '^simplify *yes'; then
    cubewright extract ct.nrrd --iso 300 -o simple.ply --min-volume 500ml --max-error 1mm -q
    cubewright check simple.ply --reference one.ply --tolerance 1mm -q
    echo "check: $?"
fi
bad() { cubewright extract "$@" || echo "exit $?"; }
bad lone.nrrd --iso 0 -o bad.ply --min-volume 1e6vox
bad ct.nrrd --iso 300 -o bad.ply --min-volume 0
bad ct.nrrd --iso 300 -o bad.ply --min-volume 5mm
ls *.ply

# Voids are filled: solids lose their cavities, and all inside them.
cubewright make sphere -o ball.nrrd --dims 24 --noise 9 -q
cubewright check "$(cubewright extract ball.nrrd --iso 0 -o all.ply -q && echo all.ply)" | grep -o '^all.ply: [^;]*'
cubewright extract ball.nrrd --iso 0 -o filled.ply --fill-voids --json r.json
sed -n -e '/"voids_filled"/,/}/p' -e '/"fill_voids"/p' r.json
cubewright check filled.ply --source ball.nrrd --iso 0 --fill-voids | grep -o -e '^filled.ply: [^;]*' -e 'topology *as the field.*'
cubewright check filled.ply --fill-voids || echo "exit $?"
bad ct.nrrd --iso 300 -o bad.ply --fill-voids --stream always
bad ct.nrrd --labels all -o bad.ply --fill-voids --stream always
# at the volume's border: cavities in solids that are capped are filled, one that the border cuts open is none
shell() {
    printf 'NRRD0005\ntype: uint8\ndimension: 3\nsizes: 10 10 %d\nencoding: ascii\n\n' "$1"
    awk -v n="$1" 'function out(a) { return a < 1 || a > 8 } function in_cavity(a) { return a > 3 && a < 6 }
        BEGIN { for (z = 0; z < n; z++) for (y = 0; y < 10; y++) for (x = 0; x < 10; x++)
            print out(x) || out(y) || out(z) || in_cavity(x) && in_cavity(y) && in_cavity(z) ? 0 : 9 }'
}
for slices in 10 8 6 5; do
    shell $slices >shell.nrrd
    cubewright extract shell.nrrd --iso 4.5 --spacing 1x1x1mm -o shell.ply --fill-voids 2>&1 | grep -o -e '[0-9]* void.*' -e '[0-9]* components*' -e 'capped.*border'
done
