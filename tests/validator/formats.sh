#!/bin/sh
# Meshes in every format, given to other people's readers, and theirs to ours: sh formats.sh
# BIN_FOLDER SERIES, where SERIES is the program that writes a .pvd. Counts, areas and volumes
# must be the same. 77 when none of VTK, PrusaSlicer, ADMesh and Assimp is there.
set -u
PATH=$1:$PATH
series=$2
here=$(cd "$(dirname "$0")" && pwd)
failed=0 asked=0
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
python=
for p in /usr/bin/python3 python3; do # Debian's has the packages
    [ -z "$python" ] && $p -c 'import vtk' 2>/dev/null && python=$p
done
has() { command -v "$1" >/dev/null; }
[ -n "$python" ] || has prusa-slicer || has admesh || has assimp || has unzip ||
    { echo "skip: neither VTK nor prusa-slicer, admesh, assimp, unzip is there" >&2; exit 77; }

# expect WHAT GOT WANTED
expect() {
    asked=$((asked + 1))
    [ "$2" = "$3" ] || { echo "$1: got ${2:-nothing}, expected $3"; failed=1; }
}

# near WHAT GOT WANTED: within a ten-thousandth, as some add up in single precision
near() {
    asked=$((asked + 1))
    echo "$2 $3" | awk '{d = $1 - $2; exit !(NF == 2 && d * d <= 1e-8 * $2 * $2)}' ||
        { echo "$1: got ${2:-nothing}, expected $3"; failed=1; }
}

# One mesh with normals, and one with colours and scalars, too (painted by check).
cubewright make gyroid -o v.nrrd --dims 24 -q
cubewright extract v.nrrd --iso 0 -o x.ply --json x.json -q || exit 1
fact() { sed -n "s/^    \"$1\": \([0-9.]*\),*$/\1/p" x.json; }
vertices=$(fact vertices) triangles=$(fact triangles) area=$(fact area) volume=$(fact volume)
cubewright check x.ply --reference x.ply --defects painted.ply -q >/dev/null
for f in obj stl off vtp 3mf; do
    cubewright convert x.ply -o x.$f -q || exit 1
    cubewright convert painted.ply -o painted.$f -q || exit 1
done
cubewright convert x.ply -o text.ply --ascii -q && cubewright convert x.ply -o text.stl --ascii -q ||
    exit 1
cat >two.obj <<'END'
o a & <b>
v 0 0 0
v 30 0 0
v 0 30 0
v 0 0 30
f 1 3 2
f 1 2 4
f 1 4 3
f 2 3 4
o other
v 50 0 0
v 80 0 0
v 50 30 0
v 50 0 30
f 5 7 6
f 5 6 8
f 5 8 7
f 6 7 8
END
cubewright convert two.obj -o two.3mf -q || exit 1

ask_vtk() {
    $python "$here/vtk_meshes.py" x.ply x.obj x.stl x.vtp text.ply text.stl painted.vtp >said ||
        { failed=1; return; }
    while read -r name p t a v arrays; do
        case $name in # OBJ's points are those of faces; STL's are merged; paint splits some
        *.obj | *.stl | painted*) ;;
        *) expect "VTK $name points" "$p" "$vertices" ;;
        esac
        expect "VTK $name triangles" "$t" "$triangles"
        near "VTK $name area" "$a" "$area"
        near "VTK $name volume" "$v" "$volume"
        case $name in
        x.vtp) expect "VTK $name arrays" "$arrays" Normals ;;
        painted.vtp) expect "VTK $name arrays" "$arrays" Normals,RGBA,scalar ;;
        esac
    done <said
    mkdir run run/steps theirs
    "$series" run || failed=1
    $python "$here/vtk_meshes.py" run/run.pvd >said || failed=1
    expect "VTK .pvd" "$(awk '{print $1, ($3 > 0)}' said | tr '\n' ';')" \
        "steps/0000.vtp@0 1;steps/0001.vtp@0.25 1;steps/0002.vtp@0.5 1;"
    # and what VTK writes, in all its dialects
    $python "$here/vtk_meshes.py" --write x.stl theirs || failed=1
    for f in theirs/*.*; do
        case $f in *_*) continue ;; esac # a piece of a list beside it
        cubewright check "$f" --json r.json -q >/dev/null 2>&1
        expect "$f" "$(sed -n 's/^    "triangles": \([0-9]*\),$/\1/p' r.json)" "$triangles"
        rm -f r.json
    done
}

ask_prusa() {
    field() { sed -n "s/^$2 *= *//p" "$1.said" | head -n 1; }
    for f in x.3mf painted.3mf x.stl text.stl; do
        prusa-slicer --info $f >$f.said 2>/dev/null
        expect "PrusaSlicer $f facets" "$(field $f number_of_facets)" "$triangles"
        [ $f = painted.3mf ] || expect "PrusaSlicer $f manifold" "$(field $f manifold)" yes
        near "PrusaSlicer $f volume" "$(field $f volume)" "$volume"
    done
    expect "PrusaSlicer two.3mf objects" \
        "$(prusa-slicer --info two.3mf 2>/dev/null | grep -c '^number_of_facets = 4')" 2
    prusa-slicer --export-3mf x.stl -o theirs.3mf >/dev/null 2>&1
    cubewright check theirs.3mf --json r.json -q >/dev/null 2>&1
    expect "PrusaSlicer's 3MF" "$(sed -n 's/^    "triangles": \([0-9]*\),$/\1/p' r.json)" \
        "$triangles"
}

ask_admesh() {
    admesh text.stl >said 2>/dev/null
    field() { sed -n "s/^$1 *: *\([0-9]*\).*/\1/p" said | head -n 1; }
    expect "ADMesh text.stl facets" "$(field 'Number of facets')" "$triangles"
    expect "ADMesh text.stl normals fixed" "$(field 'Normals fixed')" 0
    expect "ADMesh text.stl disconnected" "$(field 'Total disconnected facets')" 0
}

ask_assimp() {
    for f in x.off painted.off text.ply x.3mf painted.3mf; do
        assimp info "$f" >said 2>&1
        field() { sed -n "s/^$1: *\([0-9]*\).*/\1/p" said | head -n 1; }
        expect "Assimp $f faces" "$(field Faces)" "$triangles"
    done
}

[ -z "$python" ] || ask_vtk
! has prusa-slicer || ask_prusa
! has admesh || ask_admesh
! has assimp || ask_assimp
if has unzip; then
    unzip -tq two.3mf >/dev/null
    expect "unzip -t" $? 0
fi
echo "$asked questions that others answer too"
[ $asked -ge 1 ] || failed=1
exit $failed
