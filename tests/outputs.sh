#!/bin/sh
# Prints a hash of every output of a fixed set of runs: sh outputs.sh BIN_FOLDER
# Compare the list of a build before a change with that of the build after it:
#
#   sh tests/outputs.sh build/release/bin >before.txt
#   ... a change that must keep every byte ...
#   sh tests/outputs.sh build/release/bin | diff before.txt -
#
# Times, paths and memory in what is printed are taken out. Takes half a minute.
set -u
root=$(cd "$(dirname "$0")/.." && pwd)
PATH=$(cd "$1" && pwd):$PATH
export PATH
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
mkdir in out

# run NAME ARGUMENT...: keeps what the command prints as NAME.txt, and its exit code.
run() {
    name=$1
    shift
    {
        cubewright "$@" 2>&1
        echo "exit $?"
    } | sed -E -e 's/"[a-z_]*(seconds|bytes)": [0-9.e+-]+/T/g' -e 's/[0-9.]+ (s|ms)\b/T/g' -e 's/[0-9.]+ (kB|MB|GB|bytes|B)\b/M/g' \
        -e "s|$folder|F|g" -e 's/[0-9.]+ M[a-z]+\/s/R/g' >"out/$name.txt"
}

for field in sphere gyroid torus marschner-lobb ct-head; do
    cubewright make $field -o in/$field.nrrd --dims 40 -q
done
cubewright make ct-head -o in/noisy.nii.gz --dims 48 --type i16 --noise 30 --seed 3 -q
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
