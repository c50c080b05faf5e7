#!/bin/sh
# Reads every real scan and holds what we say of it against what other people's readers say
# (truth.tsv, made by truth.py): sh scans.sh BIN_FOLDER. The scans are in $CUBEWRIGHT_DATA/data; 77
# when there is no such folder. What this build has no reader for is named and passed over.
set -uf
here=$(cd "$(dirname "$0")" && pwd)
data=${CUBEWRIGHT_DATA:-}/data
PATH=$1:$PATH
tab=$(printf '\t')
failed=0 read=0 line=0 unread=
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
[ -d "$data" ] || { echo "skip: CUBEWRIGHT_DATA names no folder with data" >&2; exit 77; }
data=$(cd "$data" && pwd)
cd "$folder" || exit 1

fail() {
    echo "$path $options: $*"
    failed=1
}

# Two slices of four bytes show whether slices with numbers can be read at all.
reads_slices() {
    printf aaaa >s.1
    printf bbbb >s.2
    cubewright info 's.*' --raw dims=2x2x2,type=u8 >out 2>err
}

# The formats that can be read, a line each.
list_readers() {
    cubewright formats --json | awk -F '"' '
        $2 == "name" { name = $4 }
        /"reads_volume": true/ { reads = name }
        /"in_this_build": true/ && reads == name { print name }'
    reads_slices && echo slices
}

# run COMMAND ARGUMENTS...: on the volume at hand. $options holds words, no file names.
run() {
    command=$1
    shift
    # shellcheck disable=SC2086
    cubewright "$command" "$data/$path" $options "$@" 2>err </dev/null
}

# What must not be meshed as it stands: exit 4, and the way on is named.
check_refused() {
    run extract --iso 0 -o x.ply -q
    code=$?
    [ $code = 4 ] || fail "exit code $code, expected 4: $(cat err)"
    grep -q -e --gaps err || fail "no word of --gaps: $(cat err)"
}

check_volume() {
    : >part.json
    run info --json --histogram 65536 >whole.json || { fail "$(cat err)"; return; }
    if [ "$box" != '*' ]; then
        run info --json --histogram 65536 --crop "$box" >part.json || fail "$(cat err)"
    fi
    run extract --iso "$iso" --open --local -q --json mesh.json -o '{level}.ply' ||
        { fail "$(cat err)"; return; }
    awk -v row=$line -f "$here/compare.awk" file=truth "$here/truth.tsv" \
        file=whole whole.json file=part part.json file=mesh mesh.json || failed=1
    find . -name '*.ply' -exec rm {} +
}

# check_series START INPUT OPTIONS...: the steps of a series, in one run, have the areas that the rows
# whose paths start so have one by one, as near as compare.awk asks.
check_series() {
    path=$1 options=--steps
    input=$data/$2
    shift 2
    cubewright extract "$input" "$@" --open --local -q --json mesh.json -o '{step}-{level}.ply' 2>err ||
        { fail "$(cat err)"; return; }
    awk -F '\t' -v path="$path" '
        FNR == NR && index($2, path) == 1 { n = split($18, row, ";"); for (i = 1; i <= n; i++) area[++want] = row[i] }
        FNR != NR && / "area": / { sub(/.*: /, ""); ++got; if ($0 + 0 < 0.95 * area[got] || $0 + 0 > 1.01 * area[got]) {
            print path ": surface " got " of the series has " $0 + 0 " mm2, alone " area[got]; bad = 1 } }
        END { if (got != want) print path ": " got + 0 " surfaces, " want " rows"; exit bad || got != want }' \
        "$here/truth.tsv" mesh.json || failed=1
    find . -name '*.ply' -exec rm {} +
}

# Files that look like volumes and are in no row: no failure, but worth a row.
name_others() {
    find "$data" -type f | awk -F '\t' -v data="$data/" '
        FNR == NR { path = $2; sub(/\*.*/, "", path); row[path]; next }
        /\.(md|txt|zraw|raw|ply|vdb|vtu|vtr|bin)$|SHA256SUMS$/ { next }
        {
            file = substr($0, length(data) + 1)
            for (path in row)
                if (index(file, path) == 1)
                    next
            print "in no row: " file
        }' "$here/truth.tsv" -
}

list_readers >readers
while IFS=$tab read -r reader path options check iso box rest; do
    line=$((line + 1))
    [ $line = 1 ] && continue
    [ "$options" = - ] && options=
    if ! grep -qx "$reader" readers; then
        unread="$unread $path"
        continue
    fi
    read=$((read + 1))
    case $check in
    refused) check_refused ;;
    *) check_volume ;;
    esac
done <"$here/truth.tsv"

check_series fmri-4d/ fmri-4d/example4d.nii.gz --iso 300 --steps all
grep -qx vti readers && check_series fingers-series/ 'fingers-series/*.vti' --iso 20,30

name_others
[ -z "$unread" ] || echo "no reader for:$unread"
echo "$read of $((line - 1)) rows"
[ $read -ge 20 ] || { echo "too few"; failed=1; }
exit $failed
