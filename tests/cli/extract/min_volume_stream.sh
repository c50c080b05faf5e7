# Small components are left out slice by slice as in memory: the same bytes, counts and volumes, for
# any layers and threads.
set -e
cubewright make gyroid -o g.nrrd --dims 60x50x40 --type u16 --noise 0.4 --seed 3 -q
compare() { # NAME FORMATS OPTIONS...
    name=$1
    formats=$2
    shift 2
    for format in $formats; do
        cubewright extract g.nrrd -o memory.$format --name a --stream never --json memory.json "$@" 2>memory.txt >/dev/null
        sed -n '/"mesh": {/,/}/p; /"components_dropped"/,/}/p; /"name"/d; /min_volume/p' memory.json >memory.facts
        sum=$(sha256sum <memory.$format)
        for slab in 1 6 64; do
            cubewright extract g.nrrd -o slices.$format --name a --stream always --slab $slab \
                --threads $((1 + slab % 2)) --json slices.json "$@" 2>slices.txt >/dev/null
            sed -n '/"mesh": {/,/}/p; /"components_dropped"/,/}/p; /"name"/d; /min_volume/p' slices.json >slices.facts
            [ "$sum" = "$(sha256sum <slices.$format)" ]
            cmp memory.facts slices.facts
            cmp memory.txt slices.txt
        done
    done
    echo "$name: the same; $(grep -c : slices.facts) facts"
    tail -n 1 slices.txt
}
compare small "ply glb stl" --iso 32767.5 --min-volume 0.001mm3
compare voxels ply --iso 32767.5 --min-volume 2vox
compare large ply --iso 32767.5 --min-volume 5ml
compare open ply --iso 32767.5 --min-volume 1vox --open
compare below ply --iso 9000 --min-volume 1vox --inside below --normals none --topology simple
# several levels
cubewright extract g.nrrd --iso 20000,40000 -o 'level-{level}.ply' --stream always --min-volume 3vox
# a surface that does not fit turns to slices
cubewright make gyroid -o h.nrrd --dims 120 --type u16 --noise 0.6 --seed 3 -q
cubewright extract h.nrrd --iso 32767.5 -o a.ply --name a --min-volume 1vox --stream never --no-check -q
cubewright extract h.nrrd --iso 32767.5 -o b.ply --name a --min-volume 1vox --memory 80M --no-check
cmp a.ply b.ply && echo "turned to slices: the same"
# in parts: 'join' leaves them out
for k in 3 1 2; do cubewright extract h.nrrd --iso 32767.5 --part $k/3 --manifest m --min-volume 1vox -q; done
cubewright join m -o b.ply --name a
cmp a.ply b.ply && echo "parts: the same"
# errors say what is wrong
try() { "$@" -q || echo "exit $?"; }
try cubewright extract h.nrrd --iso 32767.5 --part 1/3 --manifest m --min-volume 2vox
try cubewright extract g.nrrd --iso 32767.5 -o no.ply --stream always --min-volume 1e9vox
try cubewright extract g.nrrd --iso 1e6 -o no.ply --stream always --min-volume 1vox
sed 's/"min_volume_mm3": [0-9.e-]*/"min_volume_mm3": -1/' m/manifest.json >n && mv n m/manifest.json
try cubewright join m -o no.ply
# the front of noise may need more than --memory leaves
head -c 4000000 /dev/urandom >noise.raw
try cubewright extract noise.raw --raw dims=800x1000x5,type=u8 --iso 128 --memory 24M --stream always --min-volume 1vox \
    --no-check -o no.ply
ls no.* .cubewright* 2>/dev/null || echo "nothing is left behind"
