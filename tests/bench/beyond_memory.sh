#!/bin/sh
# Measures extraction from volumes up to those larger than memory: seconds, those of the processors,
# Mvoxel/s and the peak of the process. Reading and writing are included. Prints a table of Markdown.
# Usage: sh beyond_memory.sh BIN_FOLDER [EDGE...]   (512 1024; 2000 is 16 GB)
# Variables: FOLDER for the files ($TMPDIR, else /tmp), PERIODS of the gyroid along an edge (7),
# THREADS (2), RUNS (3) of each, of which the fastest counts. BIN_FOLDER holds cubewright and write_gyroid (target write_gyroid).
# Needs GNU time. Peers that are missing are left out: mpirun.openmpi, and VTK for Python.
# shellcheck disable=SC2086,SC2017 # $input is several words; products of large edges would overflow
set -eu
here=$(cd "$(dirname "$0")" && pwd)
PATH=$(cd "$1" && pwd):$PATH
shift
[ $# -gt 0 ] || set -- 512 1024
periods=${PERIODS:-7}
threads=${THREADS:-2}
runs=${RUNS:-3}
iso=32768
compressed_limit=1024 # the largest edge that is compressed, extracted in memory, and by peers
max_megabytes=40000   # of files at one time
/usr/bin/time -f %e true 2>/dev/null || { echo "GNU time is missing (package time)" >&2; exit 77; }
folder=$(mktemp -d "${FOLDER:-${TMPDIR:-/tmp}}/beyond-XXXXXX")
trap 'rm -rf "$folder"' EXIT
trap 'exit 1' HUP INT TERM
cd "$folder"
HOME=$folder
export HOME OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1

has_module() {
    cubewright version --features | grep -q "^$1 *yes"
}

available_megabytes() {
    awk '/^MemAvailable/ { print int($2 / 1024) }' /proc/meminfo
}

# The files of an edge: raw and compressed voxels, temporary files and the mesh. A triangle takes 25
# bytes in each of the last two, and there are about 12 x EDGE^2 x PERIODS.
needed_megabytes() { # EDGE
    awk -v n="$1" -v p="$periods" -v c=$compressed_limit 'BEGIN {
        print int((2 * n ^ 3 * (n <= c ? 2 : 1) + 2 * 25 * 12 * n ^ 2 * p) / 1e6) }'
}

measure() { # EDGE NAME COMMAND...
    edge=$1 name=$2
    shift 2
    : >times.txt
    for _ in $(seq "$runs"); do
        code=0
        /usr/bin/time -q -a -o times.txt -f '%e %U %S %M' "$@" >out.txt 2>&1 || code=$?
        rm -f mesh.ply
        [ $code != 0 ] || continue
        tail -3 out.txt >&2
        echo "| $edge^3 | $name | failed: exit code $code | | | |"
        return 0
    done
    sort -n times.txt | awk -v n="$edge" -v name="$name" 'NR == 1 {
        printf "| %d^3 | %s | %.1f | %.1f | %.0f | %.0f |\n",
            n, name, $1, $2 + $3, n ^ 3 / 1e6 / ($1 > 0 ? $1 : 0.01), $4 * 1024 / 1e6 }'
}

extract() { # EDGE NAME OPTIONS...
    edge=$1 name=$2
    shift 2
    measure "$edge" "$name" cubewright extract $input --iso $iso -o mesh.ply --threads "$threads" -q "$@"
}

measure_compressed() { # EDGE
    { printf 'NRRD0004\ntype: uint16\ndimension: 3\nsizes: %d %d %d\nendian: little\nencoding: gzip\n\n' \
        "$1" "$1" "$1"; gzip -1 <voxels.raw; } >voxels.nrrd
    input=voxels.nrrd
    extract "$1" "slice by slice, gzip, \`--no-check\`" --stream always --no-check
    rm voxels.nrrd
    input="voxels.raw --raw dims=$1x$1x$1,type=u16le"
}

measure_ranks() { # EDGE
    command -v mpirun.openmpi >/dev/null && has_module openmpi || return 0
    for n in 2 4; do
        measure "$1" "$n ranks of Open MPI, a thread each, \`--no-check\`; the largest rank" \
            mpirun.openmpi -n $n cubewright extract $input --iso $iso -o mesh.ply --threads 1 --no-check -q
    done
}

find_vtk() {
    for python in python3 /usr/bin/python3; do
        ! "$python" -c 'import numpy, vtkmodules' 2>/dev/null || { echo $python; return; }
    done
}

measure_vtk() { # EDGE
    python=$(find_vtk)
    [ "$python" ] || return 0
    [ "$(available_megabytes)" -gt $(($1 * $1 * $1 / 1000000 * 12)) ] ||
        { echo "$1^3 is left out for VTK, which may need more memory" >&2; return 0; }
    measure "$1" "VTK, flying edges, nothing written" \
        "$python" "$here/extract_vtk.py" voxels.raw "$1" $iso "$threads"
    measure "$1" "VTK, flying edges, PLY without normals" \
        "$python" "$here/extract_vtk.py" voxels.raw "$1" $iso "$threads" mesh.ply
}

measure_edge() { # EDGE
    needed=$(needed_megabytes "$1") free=$(df -Pm . | awk 'NR == 2 { print $4 }')
    echo "$1^3: $needed MB of files, $free MB are free; $(available_megabytes) MB of memory are available" >&2
    if [ "$needed" -gt "$free" ] || [ "$needed" -gt $max_megabytes ]; then
        echo "$1^3 is left out: its files exceed the disk, or $max_megabytes MB" >&2
        return 0
    fi
    write_gyroid "$1" "$periods" voxels.raw
    sync voxels.raw
    input="voxels.raw --raw dims=$1x$1x$1,type=u16le"
    measure "$1" "\`info --iso\`" cubewright info $input --iso $iso --threads "$threads"
    sed -n 's/^  extract *//p; s/^    \(memory\|time\)/\1/p' out.txt >&2
    extract "$1" "slice by slice" --stream always
    extract "$1" "slice by slice, \`--no-check\`" --stream always --no-check
    if [ "$1" -le $compressed_limit ]; then
        extract "$1" "slice by slice, 1 thread, \`--no-check\`" --stream always --no-check --threads 1
        extract "$1" "in memory" --stream never
        extract "$1" "in memory, \`--no-check\`" --stream never --no-check
        measure_compressed "$1"
        measure_ranks "$1"
        measure_vtk "$1"
    fi
    rm -f voxels.raw
}

echo "$threads threads, gyroid of $periods periods, u16; load before: $(cut -d' ' -f1 /proc/loadavg)" >&2
echo "| volume | run | s | processor s | Mvoxel/s | peak, MB |"
echo "| --- | --- | ---: | ---: | ---: | ---: |"
for edge in "$@"; do
    measure_edge "$edge"
done
