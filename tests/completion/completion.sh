#!/bin/sh
# Completes words in a shell as a person does: sh completion.sh BIN_FOLDER SHELL. The script is
# read by the shell, and then found where a package installs it.
set -u
here=$(cd "$(dirname "$0")" && pwd)
PATH=$1:$PATH
shell=$2
python=/usr/bin/python3
. "$here/../support/wait.sh"
[ -x $python ] || { echo "skipped: no $python"; exit 77; }
command -v "$shell" >/dev/null || { echo "skipped: no $shell"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
case $shell in
bash) place=bash-completion/completions/cubewright ;;
zsh) place=zsh/vendor-completions/_cubewright ;;
fish) place=fish/vendor_completions.d/cubewright.fish ;;
esac
mkdir -p "$folder/script" "$folder/share/${place%/*}" "$folder/read" "$folder/found"
cubewright help --completion "$shell" >"$folder/share/$place" || exit 1
cp "$folder/share/$place" "$folder/script/cubewright"
bad=0
cd "$folder/read" || exit 1
timeout $limit_s $python "$here/shell.py" "$shell" "$folder/script/cubewright" || bad=1
cd "$folder/found" || exit 1
if [ "$shell" = bash ] && [ ! -f /usr/share/bash-completion/bash_completion ]; then
    echo "not tried with the package bash-completion, which is absent"
else
    timeout $limit_s $python "$here/shell.py" "$shell" "$folder/share" || bad=1
fi
exit $bad
