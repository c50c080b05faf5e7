#!/bin/sh
# GIfTI and FreeSurfer's surfaces: what nibabel and gifti_tool write, read by us, and what we write, read
# by them: sh brain_surfaces.sh BIN_FOLDER. 77 when nibabel is missing.
set -u
PATH=$1:$PATH
here=$(cd "$(dirname "$0")" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python=
for p in /usr/bin/python3 python3; do # Debian's has the packages
    [ -z "$python" ] && $p -c 'import nibabel, numpy' 2>/dev/null && python=$p
done
[ -n "$python" ] || { echo "skip: nibabel is not there" >&2; exit 77; }
cd "$folder" && $python "$here/brain_surfaces.py"
