#!/bin/sh
# Repairs damaged meshes, and counts what came out: sh damage.sh BIN_FOLDER [OPTION...], options as of repair_all.py.
# Python is that of PYTHON, else /usr/bin/python3. Skips (77) without NumPy.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
python=${PYTHON:-/usr/bin/python3}
"$python" -c 'import numpy' 2>/dev/null || { echo "no NumPy for $python"; exit 77; }
exec "$python" -B "$here/repair_all.py" "$@"
