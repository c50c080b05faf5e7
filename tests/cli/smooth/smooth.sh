# Smoother meshes: what is printed and reported, what stays, and the same bytes for any number of threads.
cubewright version --features | grep -q '^glb *yes' || { echo "this build has no glTF" >&2; exit 77; }
cubewright make sphere -o s.nrrd --dims 32 --noise 0.4 -q
cubewright extract s.nrrd --iso 0 -o s.glb -q
cubewright smooth s.glb -o a.ply
cubewright smooth s.glb -o b.stl -n 30 -m 0.5mm --no-measure
cubewright smooth s.glb -o '{stem}-v.glb' --max-move 0.25vox -q
cubewright check s-v.glb --reference s.glb --tolerance 0.7mm --deep -q && echo "check agrees"
cubewright smooth s.glb -o p.obj --max-move 0.1% --allow-intersections --ascii -q && head -n 1 p.obj | cut -c 1
# the noise falls: RMS distance to the sphere of 30 mm
off() {
    cubewright convert "$1" -o off.ply --ascii -q
    sed '1,/end_header/d' off.ply | awk 'NF >= 6 { d = sqrt($1*$1 + $2*$2 + $3*$3) - 30; s += d * d; n++ } END { printf "%.3f\n", sqrt(s / n) }'
}
before=$(off s.glb) after=$(off a.ply)
awk "BEGIN { print ($after < 0.8 * $before ? \"less noise\" : \"$before to $after\") }"
for t in 1 3; do cubewright smooth s.glb -o t$t.glb -t $t --name t -q; done
cmp t1.glb t3.glb && echo "same"

# the report
cubewright smooth s.glb -o a.ply --json - -q | sed -n -e '/"smooth": {/,/}/p' -e '/"params"/,/}/p' -e '/"error": \[/,/"max"/p'

# the other methods: less noise for smaller moves
for method in hc 'fair' 'fair --width 8mm --iterations 2'; do
    cubewright smooth s.glb -o m.ply --method $method --json r.json -q
    sed -n -e '/"method"/p' -e '/"iterations"/p' -e '/"width_mm"/p' r.json
    now=$(off m.ply)
    awk "BEGIN { print ($now < 0.8 * $before ? \"less noise\" : \"$before to $now\") }"
done

# borders stay, unless they may move
cat >open.obj <<'E2'
v 0 0 0
v 1 0.2 0
v 2 0 0
v 0 1 0
v 1 1 0.5
v 2 1 0
v 0 2 0
v 1 2.2 0
v 2 2 0
f 1 2 5
f 1 5 4
f 2 3 6
f 2 6 5
f 4 5 8
f 4 8 7
f 5 6 9
f 5 9 8
E2
cubewright smooth open.obj -o kept.obj -m 0.1mm --no-measure
grep '^v ' kept.obj | sed -n -e 2p -e 8p
cubewright smooth open.obj -o moved.obj -m 0.1mm --no-keep-border --no-measure
grep '^v ' moved.obj | sed -n 2p | grep -c 'v 1 0.2 0'

# parts are smoothed apart, and stay parts
cubewright extract s.nrrd --iso 0 -o one.obj --name one -q
cubewright extract s.nrrd --iso 8 -o two.obj --name two -q
{ cat one.obj; awk -v n="$(grep -c '^v ' one.obj)" '/^f/ { for (i = 2; i <= 4; i++) { split($i, p, "/"); $i = p[1] + n "//" p[1] + n } } { print }' two.obj; } >both.obj
cubewright smooth both.obj -o apart.obj --no-measure -q && grep '^o' apart.obj
cubewright smooth both.obj -o joined.obj --no-measure --merge -q && grep -c '^o' joined.obj
# a file for the web
cubewright smooth s.glb -o web.glb --compress quantize --tolerance 0.01mm --no-measure -q && echo "compressed"
