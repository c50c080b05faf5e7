# Smooths the surface that is extracted: what is said, reported and recorded, and what is refused.
cubewright version --features | grep -q '^glb *yes' || { echo "this build has no glTF" >&2; exit 77; }
cubewright make sphere -o s.nrrd --dims 40 --noise 0.4 -q
cubewright extract s.nrrd --iso 0 -o raw.ply -q
off() {
    cubewright convert "$1" -o off.ply --ascii -q
    sed '1,/end_header/d' off.ply | awk 'NF >= 6 { d = sqrt($1*$1 + $2*$2 + $3*$3) - 30; s += d * d; n++ } END { printf "%.3f\n", sqrt(s / n) }'
}
before=$(off raw.ply)
for method in taubin hc:20 fair fair:8mm; do
    cubewright extract s.nrrd --iso 0 -o m.ply --smooth $method --min-volume 5ml
    now=$(off m.ply)
    awk "BEGIN { print ($now < 0.75 * $before ? \"less noise\" : \"$method: $before to $now\") }"
done
cubewright extract s.nrrd --iso 0 -o v.glb --smooth fair:4vox --max-move 0.25vox --no-measure --json r.json -q
sed -n -e '/"smooth": "/p' -e '/"max_move_mm"/p' -e '/"smooth": {/,/}/p' r.json
grep -a -o '"smoothed":"[^"]*"' v.glb
for t in 1 3; do cubewright extract s.nrrd --iso 0 -o t$t.ply --smooth fair -t $t --no-measure --name t -q; done
cmp t1.ply t3.ply && echo "same"
# with the steps behind it: simplified within a limit of the smoothed surface
cubewright extract s.nrrd --iso 0 -o less.ply --smooth taubin --simplify 0.2mm | grep -o 'within the limit of 0.2 mm'
cubewright extract s.nrrd --iso 0 -o lod.ply --smooth taubin --lod 1k,500 -q && ls lod*
bad() {
    cubewright extract "$@" -q
    echo "$? $*"
}
bad s.nrrd --iso 0 -o bad.ply --smooth loop
bad s.nrrd --iso 0 -o bad.ply --smooth taubin:0
bad s.nrrd --iso 0 -o bad.ply --smooth taubin:1001
bad s.nrrd --iso 0 -o bad.ply --smooth fair:0mm
bad s.nrrd --iso 0 -o bad.ply --max-move 1mm
bad s.nrrd --iso 0 -o bad.ply --smooth hc --stream always
bad s.nrrd --labels all -o bad.ply --smooth hc
bad s.nrrd --iso 0 --smooth hc --part 1/2 --manifest m
ls bad* 2>/dev/null
exit 0
