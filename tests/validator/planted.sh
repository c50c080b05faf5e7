#!/bin/sh
# Meshes with known faults, judged by us, by ADMesh and by PrusaSlicer: sh planted.sh BIN_FOLDER
# PLANT, where PLANT is the program that writes them. Where the three answer the same question
# they must agree, but for the differences listed here, which simplify/README.md explains.
# 77 when neither of the two is there.
set -u
PATH=$1:$PATH
plant=$2
failed=0 asked=0
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
command -v admesh >/dev/null || command -v prusa-slicer >/dev/null ||
    { echo "skip: neither admesh nor prusa-slicer is installed" >&2; exit 77; }

# Mesh, question, their answer: other than ours, and why.
known_differences() {
    cat <<'END'
duplicate open 3
opposite_duplicate open 3
fin open 3
shared_edge parts 2
bow_tie parts 2
coincident_cubes parts 2
flat_split degenerate 0
crack prusa_open 0
t_junction prusa_open 0
fin prusa_open 0
moebius prusa_open 50
moebius parts 0
END
}

# expect MESH QUESTION THEIRS OURS: theirs may be nothing, where they did not answer
expect() {
    [ -n "$3" ] || return 0
    asked=$((asked + 1))
    [ "$3" = "$4" ] && return 0
    known_differences | grep -qx "$1 $2 $3" && return 0
    echo "$1: $2: they say $3, we say $4"
    failed=1
}

ours() { # KEY of mesh in the report
    sed -n "s/^    \"$1\": \(-*[0-9]*\),*$/\1/p" report.json
}

theirs() { # LABEL: the first number behind a label in their report
    printf '%s\n' "$report" | sed -n "s/.*$1 *[:=] *\([0-9][0-9]*\).*/\1/p" | head -n 1
}

ask_admesh() { # MESH
    report=$(admesh "$1.stl" 2>/dev/null)
    one=$(theirs 'with 1 disconnected edge')
    [ -n "$one" ] || return # too few facets for it
    two=$(theirs 'with 2 disconnected edges') three=$(theirs 'with 3 disconnected edges')
    expect "$1" open $((one + 2 * two + 3 * three)) "$(ours open_edges)"
    [ "$1" = moebius ] || expect "$1" parts "$(theirs 'Number of parts')" "$(ours components)"
    expect "$1" degenerate "$(theirs '^Degenerate facets')" "$(ours degenerate)"
    # facets are also turned while holes are filled, so only closed meshes tell; and of several
    # shells only a sum is looked at
    if [ "$(ours open_edges)$(ours nonmanifold_edges)" = 00 ] && [ "$(ours components)" = 1 ]; then
        wrong=0
        [ "$(ours misoriented_edges)$(ours inside_out)" = 00 ] || wrong=1
        turned=0
        [ "$(theirs 'Facets reversed')" = 0 ] || turned=1
        expect "$1" turned $turned $wrong
    fi
}

# Asks PrusaSlicer of all files at once, as it takes long to start. One that it refuses ends it before
# it says anything: then it is asked again of the others.
ask_prusa_of_all() { # FILE...
    while [ $# -gt 0 ] && ! prusa-slicer --info "$@" >prusa 2>why; do
        refused=$(sed -n 's/: Loading of a model file failed.*//p' why)
        [ -n "$refused" ] || { cat why; failed=1; return; }
        set -- $(printf '%s\n' "$@" | grep -vx "$refused")
    done
}

ask_prusa() { # MESH: it repairs what it can before it counts
    report=$(sed -n "/^\[$1\.stl\]\$/,/^\[/p" prusa | sed '2,${/^\[/d;}')
    [ -n "$(theirs number_of_facets)" ] || return # no volume: refused
    open=$(theirs open_edges)
    expect "$1" prusa_open "${open:-0}" "$(ours open_edges)"
    expect "$1" parts "$(theirs number_of_parts)" "$(ours components)"
    flat=$(theirs degenerate_facets)
    expect "$1" degenerate "${flat:-0}" "$(ours degenerate)"
}

"$plant" . >names || exit 1
command -v prusa-slicer >/dev/null && ask_prusa_of_all $(sed 's/$/.stl/' names)
while read -r name; do
    cubewright check "$name.stl" --profile print --json report.json -q 2>/dev/null
    [ -n "$(ours components)" ] || { echo "$name: no report"; failed=1; continue; }
    command -v admesh >/dev/null && ask_admesh "$name"
    command -v prusa-slicer >/dev/null && ask_prusa "$name"
done <names
echo "$(wc -l <names) meshes, $asked questions that others answer too"
[ $asked -ge 100 ] || { echo "too few answers"; failed=1; }
exit $failed
