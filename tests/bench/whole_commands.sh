#!/bin/sh
# Measures whole commands, from a volume file to a mesh file, beside a pipeline of VTK for Python that
# does the same. Start, reading and writing are included. Prints a table of Markdown.
# Usage: sh whole_commands.sh BIN_FOLDER VOLUME ISOVALUE [VOLUME ISOVALUE...]
# VOLUME is NIfTI or MetaImage. Variables: THREADS (2), RUNS (3) of each, in turn, of which the medians
# count, FOLDER for the files ($TMPDIR, else /tmp), ERROR (0.1) in millimetres, and WORK (all), a list
# of glb, stl, ply, tenth, within and levels.
# A simplified mesh is measured against the full surface of the same program: VTK's reader places NIfTI
# elsewhere, and its surfaces end at the volume's border.
# Needs GNU time. Without VTK for Python only our commands are measured.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
PATH=$(cd "$1" && pwd):$PATH
shift
threads=${THREADS:-2}
runs=${RUNS:-3}
error=${ERROR:-0.1}
works=${WORK:-glb stl ply tenth within levels}
/usr/bin/time -f %e true 2>/dev/null || { echo "GNU time is missing (package time)" >&2; exit 77; }
start=$PWD
folder=$(mktemp -d "${FOLDER:-${TMPDIR:-/tmp}}/whole-XXXXXX")
trap 'rm -rf "$folder"' EXIT
trap 'exit 1' HUP INT TERM
cd "$folder"

find_vtk() {
    for python in python3 /usr/bin/python3; do
        ! "$python" -c 'import vtkmodules.vtkIOImage' 2>/dev/null || { echo $python; return; }
    done
}

count_triangles() { # FILE
    cubewright check "$1" --json - -q 2>/dev/null | sed -n 's/^ *"triangles": \([0-9]*\),*$/\1/p' | head -n 1
}

# The larger distance of both directions from the full surface of the same program, in millimetres.
measure_distance() { # FILE
    cubewright check "$1" --reference "full-$1" --json - -q 2>/dev/null | grep -o '"max": [0-9.e-]*' |
        awk '$2 > most { most = $2 } END { printf "%.3g", most }'
}

# Runs a command once more. The file of its first run is looked at, beside the clock.
take() { # BY OUTPUT COMMAND...
    entry=$((entry + 1)) by=$1 output=$2
    shift 2
    rm -f "$output"
    if ! /usr/bin/time -q -a -o "$entry.times" -f '%e %U %S %M' "$@" >out.txt 2>&1; then
        tail -n 3 out.txt >&2
        by="$by: failed"
    elif [ ! -e "$entry.facts" ]; then
        echo "$(count_triangles "$output") $(wc -c <"$output")" \
            "$([ "$is_simplified" = no ] || measure_distance "$output")" >"$entry.facts"
    fi
    echo "$by" >"$entry.by"
}

print_entry() { # WORK
    read -r triangles bytes distance <"$entry.facts" || triangles=0 bytes=0 distance=
    sort -n "$entry.times" | awk -v work="$1" -v by="$(cat "$entry.by")" -v volume="$name" \
        -v triangles="$triangles" -v bytes="$bytes" -v distance="$distance" '
        { wall[NR] = $1; cpu[NR] = $2 + $3; peak = $4 > peak ? $4 : peak }
        END {
            printf "| %s | %s | %s | %.2f | %.2f | %.0f | %d | %.1f | %s |\n", volume, work, by,
                wall[int((NR + 1) / 2)], cpu[int((NR + 1) / 2)], peak * 1024 / 1e6, triangles,
                bytes / 1e6, distance }'
}

# Runs all commands of a kind of work in turn, and prints their rows.
compare() { # WORK FUNCTION IS_SIMPLIFIED
    rm -f ./*.times ./*.facts
    is_simplified=$3
    for _ in $(seq "$runs"); do
        entry=0
        "$2"
    done
    count=$entry
    for entry in $(seq "$count"); do
        print_entry "$1"
    done
}

ours() { # BY OUTPUT OPTIONS...
    by=$1 output=$2
    shift 2
    take "$by" "$output" cubewright extract "$volume" --iso "$iso" -o "$output" --threads "$threads" -q "$@"
}

vtk() { # BY OUTPUT METHOD...
    [ "$python" ] || return 0
    by=$1 output=$2
    shift 2
    take "$by" "$output" "$python" "$here/whole_vtk.py" "$threads" "$volume" "$iso" "$output" "$@"
}

make_glb() {
    ours "cubewright" ours.glb
    ours "cubewright, \`--no-check\`" ours.glb --no-check
}

make_stl() {
    ours "cubewright" ours.stl
    ours "cubewright, \`--no-check\`" ours.stl --no-check
    vtk "VTK" vtk.stl
}

# VTK's writer leaves normals out.
make_ply() {
    ours "cubewright, with normals" ours.ply
    ours "cubewright, \`--no-check\`, with normals" ours.ply --no-check
    ours "cubewright, \`--no-check --normals none\`" ours.ply --no-check --normals none
    vtk "VTK" vtk.ply
}

make_tenth() {
    ours "cubewright, \`--simplify\`" ours.stl --simplify $((full / 10))
    ours "cubewright, \`--simplify --no-measure\`" ours.stl --simplify $((full / 10)) --no-measure
    ours "cubewright, \`--simplify --no-check\`" ours.stl --simplify $((full / 10)) --no-check
    vtk "VTK, vtkQuadricDecimation" vtk.stl quadric 0.1
    vtk "VTK, vtkDecimatePro" vtk.stl pro 0.1
}

make_within() {
    ours "cubewright, \`--simplify --no-measure\`" ours.stl --simplify "${error}mm" --no-measure
    bounded=$(count_triangles ours.stl)
    ours "cubewright, \`--max-error\`, measured" ours.stl --max-error "${error}mm"
    ours "cubewright, as many triangles, no limit" ours.stl --simplify "$bounded" --no-measure
    vtk "VTK, vtkQuadricDecimation, as many triangles, no limit" vtk.stl quadric \
        "$(awk -v n="$bounded" -v all="$vtk_full" 'BEGIN { print n / all }')"
}

# What the last command of a chain writes is looked at.
make_levels() {
    counts=$((full / 4)),$((full / 16)),$((full / 64))
    ours "cubewright, \`extract --lod\`" levels.glb --lod $counts --no-measure
    # shellcheck disable=SC2016 # the inner shell expands
    take "cubewright, \`extract\`, then \`simplify --lod\`" levels.glb sh -c '
        cubewright extract "$1" --iso "$2" -o between.glb --threads "$3" -q &&
            cubewright simplify between.glb --lod "$4" -o levels.glb --source "$1" --no-measure --threads "$3" -q' \
        sh "$volume" "$iso" "$threads" $counts
}

is_asked() { # WORK
    case " $works " in
    *" $1 "*) return 0 ;;
    esac
    return 1
}

tell_start() {
    [ "$python" ] || { echo "VTK for Python is missing (package python3-vtk9)" >&2; return 0; }
    /usr/bin/time -f "Python and VTK start in %e s, which their rows contain" "$python" "$here/whole_vtk.py" 1 >&2
}

measure_volume() { # VOLUME ISOVALUE
    case $1 in
    /*) volume=$1 ;;
    *) volume=$start/$1 ;;
    esac
    iso=$2 name=$(basename "$1")
    entry=0 is_simplified=no
    ours reference full-ours.stl
    vtk reference full-vtk.stl
    full=$(count_triangles full-ours.stl) vtk_full=$(count_triangles full-vtk.stl)
    ! is_asked glb || compare "all, to GLB" make_glb no
    ! is_asked stl || compare "all, to STL" make_stl no
    ! is_asked ply || compare "all, to PLY" make_ply no
    cubewright version --features | grep -q '^simplify *yes' || return 0
    ! is_asked tenth || compare "10 %, to STL" make_tenth yes
    ! is_asked within || compare "within $error mm, to STL" make_within yes
    ! is_asked levels || compare "3 levels of detail, to GLB" make_levels no
}

python=$(find_vtk)
echo "$threads threads, medians of $runs in turn; load before: $(cut -d' ' -f1 /proc/loadavg)" >&2
tell_start
echo "| volume | work | by | s | processor s | peak, MB | triangles | file, MB | farthest from all, mm |"
echo "| --- | --- | --- | ---: | ---: | ---: | ---: | ---: | ---: |"
while [ $# -ge 2 ]; do
    measure_volume "$1" "$2"
    shift 2
done
