#!/bin/sh
# Runs a test of the Python package on a built library: sh run.sh LIBRARY BUILD_FOLDER CC SCRIPT
# Python is that of PYTHON, else /usr/bin/python3. Skips (77) without NumPy 1.20.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
python=${PYTHON:-/usr/bin/python3}
"$python" -c 'import numpy.typing' 2>/dev/null || { echo "no NumPy for $python"; exit 77; }
CUBEWRIGHT_LIBRARY=$1 CUBEWRIGHT_BUILD=$2 CC=$3
PYTHONPATH=$here/../../python
PYTHONDONTWRITEBYTECODE=1
export CUBEWRIGHT_LIBRARY CUBEWRIGHT_BUILD CC PYTHONPATH PYTHONDONTWRITEBYTECODE
cd "$here"
exec "$python" -W error "$4"
