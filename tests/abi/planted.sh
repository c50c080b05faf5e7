#!/bin/sh
# Changes the interface of a small library in each way, and looks for what is reported: sh planted.sh CC.
set -u
here=$(cd "$(dirname "$0")" && pwd)
cc=$1
. "$here/abi_tools.sh"
command -v abidiff >/dev/null || { echo "no abidiff (apt-get install abigail-tools)"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
mkdir include
bad=0

build() { # SONAME_NUMBER CPPFLAG...: the library with a change, as -DCHANGE
    number=$1
    shift
    "$cc" "$@" -E -P -x c "$here/planted.c" | sed 's/^ *//' | grep -v '^#' >source || exit 1
    sed '/^typedef struct cw_hidden/q' source >include/planted.h
    case $* in *RAISE*) echo '#define CW_PLANTED_DESC_VERSION 1' >>include/planted.h ;; esac
    { echo '#include "include/planted.h"'; sed '1,/^typedef struct cw_hidden/d' source; } >planted.c
    "$cc" -g -shared -fPIC -Wl,-soname,libplanted.so."$number" planted.c -o libplanted.so || exit 1
}
passes() { # NAME
    compare_interface planted.abi libplanted.so include . >said || { echo "$1 should pass:"; cat said; bad=1; }
}
fails() { # NAME WORDS
    compare_interface planted.abi libplanted.so include . >said && { echo "$1 should fail"; bad=1; }
    grep -q -e "$2" said || { echo "$1: the report lacks: $2"; cat said; bad=1; }
}

build 0
dump_interface libplanted.so include planted.abi || exit 1
passes "no change"
build 0 -DADD_FUNCTION
passes "a new function"
build 0 -DADD_LAST
passes "a new enumerator at the end"
build 0 -DPRIVATE
passes "a change of a struct that only the library knows"
build 0 -DFILL -DRAISE
passes "a new member in the padding of a struct whose version is raised"
build 0 -DLENGTHEN -DRAISE
passes "a new member behind a struct whose version is raised"
build 0 -DFILL
fails "a new member in padding" 'cw_planted_desc grew: #define CW_PLANTED_DESC_VERSION 1'
build 0 -DLENGTHEN
fails "a new member behind a struct with a version" 'cw_planted_desc grew: #define CW_PLANTED_DESC_VERSION 1'
build 0 -DREMOVE_FUNCTION
fails "a function less" cw_second
build 0 -DADD_PARAMETER
fails "a new parameter" 'parameter 2'
build 0 -DGROW
fails "a new field at the end" 'size changed'
build 0 -DWIDEN
fails "a field of another type" "type of .*width.* changed"
build 0 -DADD_FIRST
fails "a new enumerator in front" CW_PLANTED_SMALL
build 1 -DREMOVE_FUNCTION
passes "a function less, with a new number of the soname"
build 0 -DREMOVE_FUNCTION
sed -i "s/libplanted.so.0/libplanted.so.1/" planted.abi
fails "a number of the soname that fell" cw_second
[ $bad = 0 ] && echo "eight changes were reported, and six additions passed"
exit $bad
