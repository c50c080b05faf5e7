#!/bin/sh
# Compares the binary interface of a build with that of the last release: sh abi.sh LIBRARY.
set -u
here=$(cd "$(dirname "$0")" && pwd)
library=$1
. "$here/abi_tools.sh"
command -v abidiff >/dev/null || { echo "no abidiff (apt-get install abigail-tools)"; exit 77; }
has_debug_info "$library" || { echo "no debug information: the presets minimal and dev have it"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
gzip -dc "$here/released.abi.gz" >"$folder/released.abi" || exit 1
compare_interface "$folder/released.abi" "$library" "$here/../../include/cubewright" "$folder" || exit 1
echo "the interface is that of the last release, or more"
