# Speed against error: a row of each, the same in the table, in CSV and in JSON; peers that are
# missing, that fail in every way, and that are there.
. "$TESTS/support/wait.sh"
mkdir tmp fakes none
TMPDIR=$PWD/tmp
export TMPDIR
bench=$(command -v cubewright)

# CSV without what is in quotes: 30 columns, of which 1, 7, 8 and 30 are empty then.
rows_of() {
    tail -n +2 "$1" | tr -d '\r' | sed 's/"[^"]*"//g'
}
# value_of FILE COLUMN WORK SETTING [CASE]
value_of() {
    tail -n +2 "$1" | tr -d '\r' | grep ",$3," | grep -F "\"$4\"" | grep -F "${5:-}" |
        sed 's/"[^"]*"//g' | cut -d, -f"$2"
}
below() { # below A B WHAT
    awk "BEGIN {exit !($1 < $2)}" && echo "$3" || echo "$3: $1 is not below $2"
}

cubewright bench --fields sphere,torus --sizes 16,24 --repeat 2 --json facts.json --csv rows.csv >table || exit
sed -n 1p table
grep -E '^(sphere|torus)' table
rows_of rows.csv | awk -F, 'NF != 30 {print "columns: " $0} END {print NR " rows"}'
head -n 1 rows.csv | awk -F, '{print NF " columns"}'
grep -c '^  cubewright, ' table
echo "$(grep -c '"who"' facts.json) in JSON"
sed -n 's/^  "schema": //p' facts.json
sed -n 's/^ *"triangles": \([0-9]*\),$/\1/p' facts.json >json_triangles
rows_of rows.csv | cut -d, -f15 | grep . | cmp - json_triangles && echo "JSON and CSV agree"

# What is known of the sphere: what extract makes of it, which error is the smaller.
cubewright make sphere -o sphere.nrrd --dims 24 -q
cubewright extract sphere.nrrd --iso 0 --open -o sphere.stl --json extract.json -q
full=$(sed -n 's/^ *"triangles": \([0-9]*\).*/\1/p' extract.json | head -n 1)
[ "$(value_of rows.csv 15 extraction linear sphere,24)" = "" ] || echo "quotes?"
grep '^"sphere",24' rows.csv >sphere24.csv
{ head -n 1 rows.csv; cat sphere24.csv; } >s24.csv
{ head -n 1 rows.csv; grep '^"sphere",16' rows.csv; } >s16.csv
[ "$(value_of s24.csv 15 extraction linear)" = "$full" ] && echo "the triangles of extract"
linear=$(value_of s24.csv 17 extraction linear)
below "$linear" 0.05 "vertices are near the sphere"
below "$(value_of s24.csv 17 extraction cubic)" "$linear / 50" "cubic ones nearer"
below "$linear" "$(value_of s16.csv 17 extraction linear)" "and nearer with more voxels"
below "$(value_of s24.csv 20 extraction cubic)" "$(value_of s24.csv 20 extraction linear)" "so are normals"
below 0 "$(value_of s24.csv 11 extraction linear)" "time passes"
if cubewright version --features | grep -q '^simplify *yes'; then
    below "$(value_of s24.csv 15 simplification 'to 10 %')" "0.11 * $full" "a tenth is left"
    below "$(value_of s24.csv 22 extraction linear)" "$(value_of s24.csv 22 simplification 'to 10 %')" \
        "and is farther from the sphere"
else
    echo "a tenth is left"
    echo "and is farther from the sphere"
fi
if cubewright version --features | grep -q '^glb *yes'; then
    below "$(value_of s24.csv 16 compression 'draco, 14 bits')" \
        "0.3 * $(value_of s24.csv 16 compression none)" "Draco takes less"
    below "$(value_of s24.csv 25 compression 'draco, 14 bits')" 0.01 "and moves vertices little"
else
    echo "Draco takes less"
    echo "and moves vertices little"
fi

# A file, its level found; JSON on the standard output, the table beside it.
cubewright bench sphere.nrrd --repeat 1 --json - 2>table >file.json || exit
sed -n 's/^ *"\(file\|level\|truth\)": /\1 /p' file.json
grep -c '^  cubewright, ' table

# Peers that are missing are named; nothing else fails.
PATH=$PWD/none "$bench" bench --fields sphere --sizes 16 --repeat 1 --peers --csv missing.csv >table ||
    echo "failed: $?"
grep -E 'missing' table
grep -c ',missing,' missing.csv

# The same where a python3 is, which has not what they need; and a file's name is no formula.
cat >fakes/python3 <<'F'
#!/bin/sh
echo missing vtkmodules
F
chmod +x fakes/python3
cp sphere.nrrd =1+1.nrrd
PATH=$PWD/fakes "$bench" bench =1+1.nrrd --iso 0 --repeat 1 --peers --csv missing.csv >table 2>/dev/null ||
    echo "failed: $?"
grep -E 'vtk.*missing' table
sed -n 2p missing.csv | cut -d, -f1

# Peers that fail in every way: told, and soon over.
fake() { # fake SETTING [OPTION...], the program on the standard input
    setting=$1
    shift
    [ $# -gt 0 ] || set -- --peer-timeout $limit_s
    cat >fakes/python3
    chmod +x fakes/python3
    PATH=$PWD/fakes:$PATH "$bench" bench --fields sphere --sizes 16 --repeat 1 --peers "$@" >table ||
        echo "failed: $?"
    grep -F ", $setting" table
}
fake vtkFlyingEdges3D --peer-timeout 1 <<'F'
#!/bin/sh
exec sleep 100000
F
fake vtkFlyingEdges3D <<'F'
#!/bin/sh
kill -SEGV $$
F
fake vtkFlyingEdges3D <<'F'
#!/bin/sh
echo "no	good" >&2
exit 3
F
fake vtkFlyingEdges3D <<'F'
#!/bin/sh
yes | tr -d '\n'
F
fake marching_cubes <<'F'
#!/bin/sh
echo ready 1
read line
echo ok
read line
echo ok soon 5
F
fake volumeToMesh <<'F'
#!/bin/sh
echo ready 1
read line
F
fake vtkQuadricDecimation <<'F'
#!/bin/sh
echo ready 1
while read line; do
    case $line in
    run) echo ok 0.5 1000 ;;
    save) head -c 60 /dev/zero >result; echo ok 3 2 0 ;;
    *) echo ok ;;
    esac
done
F
fake vtkFlyingEdges3D <<'F'
#!/bin/sh
echo ready 1
while read line; do
    case $line in
    run) echo ok 0.5 1000 ;;
    save) head -c 36 /dev/zero >result; printf '\001\000\000\000\002\000\000\000\003\000\000\000' >>result
        echo ok 3 1 0 ;;
    *) echo ok ;;
    esac
done
F

# Ctrl-C ends what they started, too.
cat >fakes/python3 <<F
#!/bin/sh
echo \$\$ >$PWD/started
exec sleep 100000
F
PATH=$PWD/fakes:$PATH "$bench" bench --fields sphere --sizes 16 --peers -q &
child=$!
is_started_or_over() {
    [ -s started ] || is_over $child
}
wait_until is_started_or_over
kill -TERM $child
wait $child
echo "ended with $?"
is_over "$(cat started)" || echo "its child lives"
ls tmp

# VTK itself, where it is: the same triangles in the same places, and ratios that are ratios.
real=
for p in /usr/bin/python3 "$(command -v python3)"; do
    [ -n "$real" ] || { "$p" -c 'import vtkmodules, numpy' 2>/dev/null && real=$(dirname "$p"); }
done
if [ -n "$real" ]; then
    PATH=$real:$PATH "$bench" bench --fields sphere --sizes 24 --repeat 1 --peers --peer-timeout $limit_s --threads 1 \
        --csv peers.csv >table || echo "failed: $?"
    [ "$(value_of peers.csv 15 extraction vtkFlyingEdges3D)" = "$full" ] || grep VTK table
    theirs=$(value_of peers.csv 17 extraction vtkFlyingEdges3D)
    awk "BEGIN {x = $theirs / $linear; exit !(x > 0.99 && x < 1.01)}" || echo "VTK is off by $theirs"
    rows_of peers.csv | awk -F, -v ours="$(value_of peers.csv 11 extraction linear)" -v \
        theirs="$(value_of peers.csv 11 extraction vtkFlyingEdges3D)" '
        $13 != "" {x = $13 * ours / theirs; n += x > 0.999 && x < 1.001}
        END {if (n != 1) print "ratios: " n}'
    [ "$(value_of peers.csv 15 simplification vtkQuadricDecimation)" -lt "$full" ] || grep Quadric table
fi
if command -v draco_encoder >/dev/null && [ -n "$real" ] && grep -q 'draco.*14 bits.*,done,' peers.csv; then
    a=$(value_of peers.csv 16 compression 'draco, 14 bits') b=$(value_of peers.csv 16 compression '-qp 14 -qn 10 -cl 7')
    below "$b" "1.2 * $a" "" >/dev/null
    awk "BEGIN {exit !($b < 1.2 * $a && $a < 1.5 * $b)}" || echo "draco_encoder: $b, ours $a"
fi
ls tmp

# What is refused leaves nothing.
try() {
    "$bench" bench "$@"
    echo "$?"
}
mkdir empty && cd empty || exit 1
echo "no volume" >bad.nrrd
try --fields spheer
try --fields sphere,
try --fields hard/mc33
try --sizes 4
try --sizes big
try --repeat 0
try --peer-timeout 0
try --iso 3
try nothing.nrrd
try ../sphere.nrrd bad.nrrd --csv x.csv
try ../sphere.nrrd --iso 9999 --csv x.csv
try ../sphere.nrrd --csv ../sphere.nrrd
try --json x --csv x
try --json - --csv -
try --fields sphere --sizes 8 --repeat 1 --csv no/folder.csv -q
ls
