#!/bin/sh
# Looks for what the documents point to: sh links.sh
# Every relative link leads to a file of the tree, and every #heading to a heading there. Every key
# of a paper resolves. No picture is large.
set -u
root=$(cd "$(dirname "$0")/../.." && pwd)
cd "$root" || exit 1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
bad=0 count=0

anchors_of() { # as Git hosts make them of headings
    sed -n 's/^##* //p' "$1" | tr '[:upper:]' '[:lower:]' | sed 's/[^a-z0-9 _-]//g; s/ /-/g'
}

for document in ./*.md ./*/*.md ./include/docs/*.md ./tests/*/*.md; do
    case $document in ./build/*) continue ;; esac
    sed 's/`[^`]*`//g' "$document" | grep -o '](\([^)]*\))' | sed 's/^](//; s/)$//' >"$folder/links"
    while IFS= read -r link; do
        case $link in http*) continue ;; esac
        count=$((count + 1))
        path=${link%%#*}
        file=$document
        [ -z "$path" ] || file=$(dirname "$document")/$path
        [ -e "$file" ] || { echo "$document: $link leads nowhere"; bad=1; continue; }
        case $link in
        *'#'*) anchors_of "$file" | grep -q -x -F -e "${link#*#}" ||
            { echo "$document: $link: $file has no such heading"; bad=1; } ;;
        esac
    done <"$folder/links"
done
# Keys of papers, such as [Lorensen1987], stand in a list of papers or sources.
key='\[[A-Z][A-Za-z]*\(19\|20\)[0-9][0-9]\]'
grep -r -h -o "$key" include core extract simplify formats viewer cli tests/support | sort -u >"$folder/keys"
grep -h -o "^- $key" ./*/*.md | sed 's/^- //' >"$folder/papers"
grep -v -x -F -f "$folder/papers" "$folder/keys" >"$folder/missing" &&
    { sed 's/$/ is in no list of papers/' "$folder/missing"; bad=1; }
[ -s "$folder/keys" ] || { echo "no keys of papers found"; bad=1; }

# A picture takes 400 kB at most, or nobody waits for the page.
find . -path ./build -prune -o \( -name '*.png' -o -name '*.jpg' \) -size +400k -print >"$folder/large"
[ ! -s "$folder/large" ] || { sed 's/$/ is larger than 400 kB/' "$folder/large"; bad=1; }

[ "$count" -gt 0 ] || { echo "no links found"; bad=1; }
echo "$count links"
exit $bad
