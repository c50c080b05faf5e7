#!/bin/sh
# Prints a hash of every output of a fixed set of runs: sh outputs.sh BIN_FOLDER
# Compare the list of a build before a change with that of the build after it:
#
#   sh tests/outputs.sh build/release/bin >before.txt
#   ... a change that must keep every byte ...
#   sh tests/outputs.sh build/release/bin | diff before.txt -
#
# Each run gives its files, what it prints on the standard output (NAME.out: reports, mostly JSON)
# and its messages and exit code (NAME.txt). Times, paths and memory in them are taken out.
# Takes about a minute.
set -u
root=$(cd "$(dirname "$0")/.." && pwd)
PATH=$(cd "$1" && pwd):$PATH
export PATH
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
mkdir in out

# Takes times, memory and paths out of a text.
strip() {
    sed -E -e 's/"[a-z_]*(seconds|bytes|_per_second)": [0-9.e+-]+/T/g' -e 's/[0-9.]+ (s|ms)\b/T/g' \
        -e 's/[0-9.]+ (kB|MB|GB|bytes|B)\b/M/g' -e "s|$folder|F|g" -e 's/[0-9.]+ M[a-z]+\/s/R/g'
}

# run NAME ARGUMENT...: keeps what the command prints, and its exit code.
run() {
    name=$1
    shift
    cubewright "$@" >printed 2>messages
    echo "exit $?" >>messages
    strip <messages >"out/$name.txt"
    [ ! -s printed ] || strip <printed >"out/$name.out"
}

for field in sphere gyroid torus marschner-lobb ct-head; do
    cubewright make $field -o in/$field.nrrd --dims 40 -q
done
cubewright make ct-head -o in/noisy.nii.gz --dims 32 --type i16 --noise 150 --seed 3 -q
cubewright make hard/mc33 -o in/hard.nrrd --dims 24 -q

for field in sphere gyroid torus marschner-lobb ct-head; do
    iso=0
    [ $field = marschner-lobb ] && iso=0.5
    [ $field = ct-head ] && iso=300
    run extract-$field extract in/$field.nrrd --iso $iso -o out/$field.stl
    run open-$field extract in/$field.nrrd --iso $iso --open --snap 0.2 -o out/$field-open.ply
    run cubic-$field extract in/$field.nrrd --iso $iso --placement cubic -o out/$field-cubic.obj
    run reduced-$field extract in/$field.nrrd --iso $iso --simplify 0.2vox -o out/$field-reduced.ply
    run info-$field info in/$field.nrrd
done
for extension in stl ply obj off 3mf glb gltf drc vtp; do
    run write-$extension extract in/noisy.nii.gz --iso 300 -o out/noisy.$extension
    run convert-$extension convert out/gyroid.stl -o out/converted.$extension
done
for extension in nrrd nii nii.gz mha; do
    run volume-$extension make gyroid -o out/gyroid.$extension --dims 20 --type f32
    run volume-info-$extension info out/gyroid.$extension
done
cubewright make labels/cells -o in/labels.nrrd --dims 40 --labels 12 -q
for extension in glb stl ply 3mf; do
    run labels-$extension extract in/labels.nrrd --labels all -o out/labels.$extension
done
for codec in draco meshopt; do
    run compress-$codec extract in/noisy.nii.gz --iso 300 -o out/$codec.glb --compress $codec
done
run simplify-error simplify out/gyroid.stl -o out/simple-error.stl --error 0.3mm
run simplify-count simplify out/gyroid.stl -o out/simple-count.ply --triangles 2k --no-measure
run simplify-ratio simplify out/noisy.ply -o out/simple-ratio.ply --ratio 0.3 --keep-border
run simplify-lod simplify out/gyroid.stl -o out/levels.glb --lod 4k,2k,1k
run simplify-field simplify out/gyroid.stl -o out/simple-field.ply --error 0.2mm --source in/gyroid.nrrd --iso 0
run smooth smooth out/noisy.ply -o out/smooth.ply --max-move 0.5mm
run smooth-open smooth out/gyroid-open.ply -o out/smooth-open.ply -n 30 --no-keep-border
run hollow hollow out/sphere.stl -o out/hollow.stl --wall 3mm --drain 4mm@-z --voxel 1mm
run offset offset out/torus.stl -o out/offset.stl --by 1mm --voxel 1mm
run rebuild offset out/torus.stl -o out/rebuild.stl --by 0 --voxel 1mm
for profile in basic print web fem; do
    run check-$profile check out/gyroid.stl --profile $profile --deep --defects out/defects-$profile.ply
done
run check-source check out/ct-head.stl --source in/ct-head.nrrd --iso 300 --histogram
run check-reference check out/simple-error.stl --reference out/gyroid.stl --tolerance 0.3mm
run convert-merge convert out/levels.glb -o out/merged.stl --merge
run convert-unit convert out/gyroid.stl -o out/inch.stl --input-unit in
cubewright render in/gyroid.nrrd --camera 30,20 --save-camera in/camera.json -o in/none.png -q
run pixels extract in/gyroid.nrrd --iso 0 --camera in/camera.json --pixel-error 1 --cull --size 200x150 -o out/pixels.stl
run prove extract in/gyroid.nrrd --iso 0 --crop 4:30,4:30,4:30 --prove-crop -o out/crop.stl
run least extract in/noisy.nii.gz --iso 300 --min-volume 30vox --max-error 0.2vox -o out/least.stl
for mode in mesh composite mip minip average local-mip projection splat splat-tree texture \
    shaded-texture slices vbuffer reference; do
    run render-$mode render in/noisy.nii.gz --mode $mode --iso 300 --size 160x120 -o out/render-$mode.png
done
run render-mesh render out/gyroid.stl --size 160x120 -o out/render-mesh-file.png
run render-compare render in/noisy.nii.gz --compare 'mip|reference' --size 120x90 -o out/compare.png
run render-cpu render in/noisy.nii.gz --mode mesh --iso 300 --backend cpu --size 120x90 -o out/cpu.png
run render-turn render in/gyroid.nrrd --mode mip --turntable 3 --size 80x60 -o 'out/turn-{turn}.png'
run extract-hard extract in/hard.nrrd --iso 0 -o out/hard.ply
run report-extract extract in/ct-head.nrrd --iso 300 --simplify 0.2vox --json - -o out/json.glb
run report-simplify simplify out/gyroid.stl --ratio 0.2 --json - -o out/json.ply
run report-info info in/ct-head.nrrd --json
# Every step on every source. `surface NAME SOURCE... -- STEP...`: extracts a report and a file.
cubewright make sphere -o in/paint.nrrd --dims 32 -q
cubewright make gyroid -o in/later.nii.gz --dims 32 --type i16 -q
mkdir in/series
cp in/noisy.nii.gz in/series/n1.nii.gz
cubewright make ct-head -o in/series/n2.nii.gz --dims 32 --type i16 --noise 150 --seed 4 -q
steps() {
    cat <<'EOT'
plain
volume --min-volume 0.2vox
largest --largest 40
voids --largest 60 --fill-voids
taubin --smooth taubin:5
hc --smooth hc:5 --max-move 0.2vox
fair --smooth fair:4vox
cut --cut-plane z=40%
paint --color-by in/paint.nrrd --colormap hot
flat --normals none
snap --snap 0.3
error --simplify 0.3vox
count --simplify 800
proved --max-error 0.3vox
print --profile print --plate 40x40x40mm
volume-error --min-volume 0.2vox --simplify 0.3vox
smooth-count --smooth taubin:5 --simplify 2k
cut-error --cut-plane -z=60% --simplify 0.2vox
all --min-volume 0.1vox --largest 30 --fill-voids --smooth taubin:5 --cut-plane x=30% --simplify 0.3vox --color-by in/paint.nrrd
levels --lod 2k,500
levels-all --lod 2k,500 --min-volume 0.1vox --largest 30 --fill-voids --smooth hc:3 --cut-plane x=30% --color-by in/paint.nrrd
unmeasured --smooth taubin:5 --simplify 0.3vox --no-measure
unchecked --largest 50 --fill-voids --simplify 900 --no-check
EOT
}
steps | while read -r step options; do
    # shellcheck disable=SC2086 # words of options
    {
        run memory-$step extract in/noisy.nii.gz --iso 300 $options --json - -o out/memory-$step.ply
        run slices-$step extract in/noisy.nii.gz --iso 300 $options --json - -o out/slices-$step.ply --stream always --slab 8
        run steps-$step extract 'in/series/*' --iso 300 $options --json - -o out/steps-$step-{step}.ply
        run frames-$step extract 'in/series/*' --iso 300 $options --json - -o out/frames-$step.glb --animate
        run isos-$step extract in/noisy.nii.gz --iso 300,600 $options --json - -o out/isos-$step-{level}.ply
        run seen-$step extract in/gyroid.nrrd --iso 0 $options --json - -o out/seen-$step.stl --camera in/camera.json --pixel-error 2 --size 100x80
        run cells-$step extract in/labels.nrrd --labels all $options --json - -o out/cells-$step.glb
        for part in 1 2 3; do
            run part-$step-$part extract in/noisy.nii.gz --iso 300 $options --part $part/3 --manifest in/parts-$step
        done
        run join-$step join in/parts-$step -o out/join-$step.ply
    } </dev/null
done
run join-volume-later join in/parts-plain -o out/join-plain.glb --name bone
run labels-off extract in/labels.nrrd --labels 1,3-5 --smooth-labels off --json - -o out/labels-off.vtp
run labels-each extract in/labels.nrrd --labels all --json - --table out/labels-each.csv -o out/labels-each-{label}.stl
run labels-shared extract in/labels.nrrd --labels all --shared-faces --simplify 0.3vox --json - -o out/labels-shared.ply
run labels-alone extract in/labels.nrrd --labels all --per-label --simplify 3k --json - -o out/labels-alone.3mf
run labels-slices extract in/labels.nrrd --labels all --stream always --json - -o out/labels-slices.glb
run labels-pyramid extract in/labels.nrrd --labels all --lod 4k,1k --json - --format neuroglancer -o out/pyramid
find out/pyramid -type f | sort | while read -r file; do
    cp "$file" "out/pyramid-$(echo "${file#out/pyramid/}" | tr / -)"
done
rm -rf out/pyramid
# Work on meshes.
run repair-noisy repair out/noisy.ply --json - -o out/repair-noisy.ply
run repair-open repair out/gyroid-open.ply --json - -o out/repair-open.stl
run repair-flat repair out/gyroid-open.ply --flat --fill 20mm --json - -o out/repair-flat.stl
run repair-wrap repair out/torus.stl --wrap 3mm --json - -o out/repair-wrap.stl
run remesh remesh out/sphere.stl --edge 2mm --json - -o out/remesh.ply
run remesh-adaptive remesh out/torus.stl --adaptive --error 0.1mm --edge 6mm --json - -o out/remesh-adaptive.ply
run remesh-fem remesh out/ct-head.stl --edge 3mm --fem -n 3 --json - -o out/remesh-fem.stl
run smooth-hc smooth out/noisy.ply --method hc -n 7 --orient --json - -o out/smooth-hc.ply
run smooth-fair smooth out/memory-paint.ply --method fair --width 4mm --json - -o out/smooth-fair.ply
run convert-cut convert out/memory-paint.ply --cut-plane 10,10,10:1,1,1 --orient --json - -o out/convert-cut.ply
run convert-split convert out/labels.glb --split --json - -o out/split-{part}.stl
run simplify-paint simplify out/memory-paint.ply --ratio 0.3 --json - -o out/simplify-paint.ply
run hollow-json hollow out/sphere.stl --wall 2mm --voxel 1mm --json - -o out/hollow-json.stl
run check-print check out/memory-print.ply --profile print --json -
run check-iso check out/memory-taubin.ply --source in/noisy.nii.gz --iso 300 --largest 1 --fill-voids --json -
# Python, if it has NumPy: hashes of a mesh's arrays by each option of extract().
if PYTHONPATH=$root/python CUBEWRIGHT_LIBRARY=$(dirname "$(command -v cubewright)")/../lib/libcubewright.so "${PYTHON:-/usr/bin/python3}" \
    "$root/tests/outputs.py" in/noisy.nii.gz in/labels.nrrd >out/python.out 2>/dev/null; then :; else
    echo "no Python" >out/python.out
fi
# Files of all formats, many of them broken: what readers make and say of them.
for file in "$root"/tests/fuzz/corpus/*/*; do
    name=$(basename "$(dirname "$file")")-$(basename "$file")
    cp "$file" "in/$name"
    case $name in
    fuzz_mesh_*) run "$name" convert "in/$name" -o "out/$name.ply" ;;
    fuzz_transfer*) run "$name" render in/gyroid.nrrd --transfer "in/$name" --size 40x30 -o "out/$name.png" ;;
    *) run "$name" info "in/$name" ;;
    esac
done
run wrong-mode render in/gyroid.nrrd --mode none -o out/none.png
run wrong-iso extract in/gyroid.nrrd --iso 99 -o out/none.stl
run formats formats
for command in $(cubewright help | sed -n '/^Commands/,/^$/s/^  \([a-z]*\) .*/\1/p'); do
    run help-$command help $command
done
cd out && sha256sum * | awk '{ print substr($1, 1, 16), $2 }'
