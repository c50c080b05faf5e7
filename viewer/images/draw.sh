#!/bin/sh
# Draws the pictures of the documents again: sh draw.sh BIN_FOLDER [NAME...]. Names are hero,
# modes, extraction, window and report; default: all, in four to eight minutes on two cores.
#
# Scans come from the Debian package mricron-data, all other data from `cubewright make`.
# Composing needs python3-pil, python3-vtk9, fonts-dejavu-core and chromium. Nobody but the
# person who draws needs them. Every number in a picture is read from the program's reports.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
PATH=$1:$PATH
export PATH
shift
[ $# -gt 0 ] || set -- hero modes extraction window report
scans=/usr/share/mricron/templates
[ -r $scans/ch2better.nii.gz ] || { echo "draw.sh: install mricron-data" >&2; exit 1; }
for python in python3 /usr/bin/python3 none; do
    $python -c 'import PIL, vtk' 2>/dev/null && break
done
[ "$python" != none ] || { echo "draw.sh: install python3-pil and python3-vtk9" >&2; exit 1; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

compose() { "$python" "$here/compose.py" "$@"; }
get() { compose get "$@"; }

# A brain: opaque where the cortex begins, and lighter towards white matter.
cat >brain.json <<'END'
{"schema": "cubewright-transfer-1", "unit_mm": 0.5,
 "colors": [[68, "#a85a52"], [82, "#d39a86"], [96, "#e6c3a8"], [112, "#f3e0c8"], [130, "#fffaf0"]],
 "opacities": [[68, 0], [73, 0.9]]}
END
light='0.5,0.7,1;-1,0.1,0.4,0.35,0.38,0.45'

# The cortex, for the outside of the cut brain.
make_cortex() {
    [ -e cortex.ply ] || cubewright extract $scans/ch2better.nii.gz --iso 66 \
        --min-volume 1000mm3 --simplify 400k -o cortex.ply -q
}

# The brain as a volume with an octant cut away, beside its simplified surface.
draw_hero() {
    make_cortex
    cubewright extract $scans/ch2better.nii.gz --iso 66 --min-volume 1000mm3 --max-error 0.5mm \
        -o small.ply --json small.json -q
    cubewright check small.ply 2>/dev/null | grep -q '^ *ok *closed' || exit 1
    look="--size 640x600 --samples 3 --background #161b22 --ambient 0.36 --diffuse 0.64"
    look="$look --specular 0.22 --shininess 24 --light $light -q"
    # shellcheck disable=SC2086
    cubewright render $scans/ch2better.nii.gz --mode composite --no-lit --mesh cortex.ply \
        --color '#e09a8c' --tf brain.json --camera 48,28 --zoom 1.7 --save-camera camera.json \
        --clip '1,0,0,3;0,-1,0,-12;0,0,1,15' --cut-away $look -o volume.png
    # shellcheck disable=SC2086
    cubewright render small.ply --wireframe --color '#d9c9b0' --camera camera.json $look \
        -o mesh.png
    compose sheet "$here/hero.jpg" 2 "" \
        volume.png "$(get '{0[0]} x {0[1]} x {0[2]} voxels' small.json input.dims)" \
        "the surface with an octant cut away, and the volume inside" \
        mesh.png "$(get '{:,} triangles' small.json mesh.triangles)" \
        "$(get 'closed manifold, at most {:.3f} mm from the full surface of {:,}' small.json \
            proof.max_mm small.json proof.full_triangles)"
}

# The signal of Marschner and Lobb, on which filters and sampling differ most.
draw_modes() {
    cubewright make marschner-lobb -o signal.nrrd --dims 41 -q
    cat >signal.json <<'END'
{"schema": "cubewright-transfer-1", "unit_mm": 0.05,
 "colors": [[0, "#3b1d8f"], [0.3, "#2f6fd0"], [0.5, "#27c3a0"], [0.62, "#f6d743"],
            [0.8, "#f07f2e"], [1, "#d42a4b"]],
 "opacities": [[0, 0], [0.44, 0], [0.5, 0.7], [0.56, 0], [0.8, 0], [0.9, 0.25], [1, 0.3]]}
END
    cat >camera.json <<'END'
{"schema": "cubewright-camera-1", "eye": [3.0, -5.2, 3.4], "target": [0, 0, -0.42],
 "up": [0, 0, 1], "fov_deg": 22.5}
END
    set --
    for mode in reference vbuffer composite texture shaded-texture projection splat splat-tree \
        error mesh mip local-mip average minip slices; do
        look="--size 192x166 --camera camera.json --background #161b22 -q"
        volume="signal.nrrd --tf signal.json --mode $mode" against=reference note=
        again="--turntable 5 --orbit 0"
        case $mode in
        error) # from the comparison of composite, drawn before
            set -- "$@" error.png "composite - reference" "20 times as strong"
            continue
            ;;
        reference) again= ;;
        mesh) volume="signal.nrrd --iso 0.5 --color #2fb08c" against= ;;
        slices) against= ;;
        splat-tree) volume="$volume --tree-error 0.05" ;;
        local-mip) volume="$volume --threshold 0.5" ;;
        esac
        case $mode in # what shows the whole cube, and what has a finest sampling of its own
        mip | minip | local-mip | average | slices)
            look="--size 192x166 --camera 30,32 --zoom 1.08 --background #161b22 -q"
            ;;
        esac
        case $mode in
        mip | minip | local-mip | average) against="$mode,cell-steps,exact-filter" note='*' ;;
        esac
        # shellcheck disable=SC2086
        cubewright render $volume $look $again -o "$mode{turn}.png" \
            --json $mode.json
        text=$(get "{:.0f} ms" $mode.json pictures.seconds:ms)
        [ $mode = reference ] && text="the integral itself, $text"
        if [ -n "$against" ] && [ $mode != reference ]; then
            volume=$(echo "$volume" | sed "s/--mode $mode//; s/--tree-error [0-9.]*//")
            side=$mode
            [ $mode = splat-tree ] && side=splat-tree,tree-error=0.05
            # shellcheck disable=SC2086
            cubewright render $volume $look --compare "$side|$against" --difference 20 \
                -o both.png --json both.json
            text="rmse $(get '{:.2f}' both.json pictures.0.comparison.rmse)$note, $text"
            [ $mode = composite ] && compose part both.png error.png 0.6666667 1
        fi
        set -- "$@" "$mode"0.png $mode "$text"
    done
    compose sheet "$here/modes.png" 5 "rmse of 255 over what the reference covers, against reference; \
* against the same mode with --cell-steps --exact-filter.
ms: a picture with its PNG, median of 4 after the first (of reference, the first); $(get '{}' composite.json backend); \
$(nproc) cores." "$@"
}

# Our surfaces beside VTK's, of the same padded volumes.
draw_extraction() {
    look="--size 596x400 --samples 3 --background #ffffff --wireframe -q"
    set --
    cubewright make hard/tilted-sheet -o sheet.mha --dims 20 --type f32 -q
    compose pad sheet.mha -1000 padded.mha
    cat >camera.json <<'END'
{"schema": "cubewright-camera-1", "eye": [55, 42, 80], "target": [0, 0, 0], "up": [0, 0, 1],
 "height_mm": 17}
END
    counts() {
        get "{:,} triangles, {} open edges, {} non-manifold edges, {:,} of zero area" \
            "$1" mesh.triangles "$1" mesh.open_edges "$1" mesh.nonmanifold_edges \
            "$1" mesh.degenerate
    }
    both() { # both VOLUME ISOVALUE
        compose surface "$1" "$2" vtk.ply
        cubewright extract "$1" --iso "$2" -o ours.ply -q
        for who in vtk ours; do # what does not hold is what the picture shows
            cubewright check $who.ply --defects $who-painted.ply --json $who.json -q >/dev/null 2>&1 ||
                [ $? = 1 ]
        done
    }
    both padded.mha 0
    for who in vtk ours; do
        # shellcheck disable=SC2086
        cubewright render $who.ply --color '#e0b070' --camera camera.json $look -o sheet-$who.png
    done
    set -- sheet-vtk.png "vtkFlyingEdges3D: $(get '{} holes through the sheet' vtk.json mesh.genus)" \
        "hard/tilted-sheet, a sheet one voxel thick
$(counts vtk.json)" \
        sheet-ours.png "cubewright: $(get '{} holes through the sheet' ours.json mesh.genus)" \
        "the topology of the trilinear field
$(counts ours.json)"

    compose pad $scans/ch2.nii.gz 0 whole.mha
    both whole.mha 80
    vtk_counts=$(counts vtk.json) ours_counts=$(counts ours.json)
    vtk_bad=$(get '{:,} non-manifold edges' vtk.json mesh.nonmanifold_edges)
    ours_bad=$(get '{:,} non-manifold edges' ours.json mesh.nonmanifold_edges)
    compose pad $scans/ch2.nii.gz 0 box.mha 88 92 154 4
    both box.mha 80
    for who in vtk ours; do
        # shellcheck disable=SC2086
        cubewright render $who-painted.ply --camera iso --zoom 1.45 $look -o box-$who.png
    done
    compose sheet "$here/extraction.jpg" 2 "Second row: a box of 9 voxels, painted by check --defects; \
magenta: non-manifold, red: seen from behind, black: next to a triangle of zero area. Counts are of the whole head." "$@" \
        box-vtk.png "vtkFlyingEdges3D: $vtk_bad" "head MRI in whole numbers, isovalue 80
$vtk_counts" box-ours.png "cubewright: $ours_bad" "the same voxels and isovalue
$ours_counts"
}

# The window with its panels, drawn without a display.
draw_window() {
    make_cortex
    ln -sf $scans/ch2better.nii.gz brain.nii.gz
    cubewright view brain.nii.gz --hidden --size 1280x800 --mode composite --no-lit --samples 2 \
        --mesh cortex.ply --color '#e09a8c' --tf brain.json --camera 48,28 --layout quad \
        --clip '1,0,0,4;0,-1,0,-12;0,0,1,26' --cut-away -q \
        --exec 'cross 4 12 26; window 30 130; dolly 1.5; pan 0 -12; wait; capture window.png'
    compose pages "$here/window.png" 1280 window.png
}

# Two parts of the report: its head, and a section with a plot.
draw_report() {
    ln -sf $scans/ch2bet.nii.gz brain.nii.gz
    cubewright report brain.nii.gz --iso 60 --budget 120s -o report.html -q
    shot() { # shot NAME STYLE
        sed "s|</style>|$2</style>|" report.html >"$1.html"
        chromium --headless --no-sandbox --disable-gpu --hide-scrollbars --window-size=960,2400 \
            --screenshot="$folder/$1.png" "file://$folder/$1.html" >/dev/null 2>&1
        compose trim "$1.png" "$1-trimmed.png"
    }
    shot head 'section,section~*{display:none!important}'
    shot plot 'main>:not(#simplification){display:none!important}#simplification tbody:nth-of-type(n+6){display:none}'
    compose pages "$here/report.png" 1040 head-trimmed.png plot-trimmed.png
}

for name; do
    "draw_$name"
    ls -l "$here/$name".*
done
