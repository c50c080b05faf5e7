#!/bin/sh
# Compiles uses of what CW_DEPRECATED marks: sh deprecated.sh CC.
# They compile with a warning that names the replacement; nothing else gives one.
set -u
here=$(cd "$(dirname "$0")" && pwd)
cc=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
cat >uses.c <<'END'
#include <cubewright/core.h>

CW_DEPRECATED("use cw_new()") int cw_old(void);
typedef struct cw_options {
    int ratio;
    int share CW_DEPRECATED("use ratio");
} cw_options;

int main(void)
{
#ifdef OLD
    cw_options options = {0};
    options.share = 1;
    return cw_old() + options.share;
#else
    return (cw_options){.ratio = 0}.ratio;
#endif
}
END
"$cc" -std=c99 -Wall -Wextra -Werror -I "$here/../../include" -c uses.c || { echo "an unused old name gives a warning"; exit 1; }
"$cc" -std=c99 -Wall -DOLD -I "$here/../../include" -c uses.c 2>said || { cat said; echo "an old name does not compile"; exit 1; }
for words in 'use cw_new()' 'use ratio'; do
    grep -q "warning:.*deprecated.*$words" said || { cat said; echo "no warning names: $words"; exit 1; }
done
echo "old names give a warning with the replacement"
