#!/bin/sh
# Makes the dump of the interface at a release: sh tests/abi/update.sh BUILD_FOLDER, of the preset minimal.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
library=$1/lib/libcubewright.so
. "$here/abi_tools.sh"
command -v abidw >/dev/null || { echo "no abidw (apt-get install abigail-tools)"; exit 1; }
has_debug_info "$library" || { echo "$library has no debug information: build the preset minimal"; exit 1; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
dump_interface "$library" "$here/../../include/cubewright" "$folder/released.abi"
gzip -9 -n <"$folder/released.abi" >"$here/released.abi.gz"
echo "$(grep -c '<elf-symbol ' "$folder/released.abi") symbols, $(wc -c <"$here/released.abi.gz") bytes: commit tests/abi/released.abi.gz"
