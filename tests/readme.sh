#!/bin/sh
# Runs what the README shows: sh readme.sh BIN_FOLDER BUILD_FOLDER CC.
# In a `console` block lines after "$ " are commands; what they print must be the lines that
# follow, '*' and seconds aside. The one `c` block must compile against the library and run.
set -u
root=$(cd "$(dirname "$0")/.." && pwd)
bin=$1 build=$2 cc=$3
PATH=$bin:$PATH
export PATH
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/work"
cd "$folder/work" || exit 1

# The README's examples use a head scan: the real one where Debian's package has put it.
ln -s /usr/share/mricron/templates/ch2.nii.gz head.nii.gz
[ -r head.nii.gz ] || { rm head.nii.gz; cubewright make ct-head -o head.nii.gz --dims 181x217x181 \
    --type u8 -q; made=yes; }

# Commands that this build is without are left out.
simplify=$(cubewright version --features | sed -n 's/^simplify *//p')
gl=$(cubewright version --features | sed -n 's/^gl *//p')
window=$(cubewright version --features | sed -n 's/^window *//p')
level_set=$(cubewright version --features | sed -n 's/^level-set *//p')

awk '/^```console$/ {on = 1; next} /^```/ {on = 0} on' "$root/README.md" >../console
awk '/^```c$/ {on = 1; next} /^```/ {on = 0} on' "$root/README.md" >example.c

bad=0 count=0
finish() { # compares what the last command printed
    [ -n "${made:-}" ] && return # another head, other numbers
    sed 's/[0-9.]* s$/* s/' ../wanted >../pattern
    awk -f "$root/tests/cli/match.awk" ../pattern ../got || { echo "printed by: $command"; bad=1; }
}
command=
: >../wanted
while IFS= read -r line; do
    case $line in
    '$ '*)
        [ -n "$command" ] && finish
        command=${line#'$ '}
        : >../wanted
        case $simplify$command in no*'cubewright simplify'*) command=; continue ;; esac
        case $window$gl$command in *no*'cubewright view'*) command=; continue ;; esac
        case $level_set$command in no*'cubewright hollow'* | no*'cubewright offset'*) command=; continue ;; esac
        case $gl$command in no*'cubewright render'*' --layout'* | no*'cubewright render'*' --mode'* | \
            no*'cubewright render'*' --compare'*) command=; continue ;; esac
        sh -c "$command" >../got 2>&1 </dev/null || { echo "failed: $command"; cat ../got; bad=1; }
        count=$((count + 1))
        ;;
    *) printf '%s\n' "$line" >>../wanted ;;
    esac
done <../console
[ -n "$command" ] && finish
[ "$count" -gt 0 ] || { echo "the README shows no commands"; bad=1; }

"$cc" -std=c99 -Wall -Wextra -Werror -I "$root/include" example.c -L "$build/lib" -lcubewright \
    -Wl,-rpath,"$build/lib" -o example && ./example && [ -s head.stl ] ||
    { echo "the README's C example does not work"; bad=1; }
echo "$count commands and one C program of the README ran"
exit $bad
