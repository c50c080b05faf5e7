#!/bin/sh
# The page of report in Chromium: sh report.sh BIN_FOLDER. Its script has to run (each command gets
# a button), nothing may be wider than the window, wide or narrow, dark and light must differ, and
# it must not reach for any other file. 77 when Chromium is not there.
set -u
PATH=$1:$PATH
export PATH
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
command -v chromium >/dev/null || { echo "skip: chromium is not installed" >&2; exit 77; }
cubewright report gyroid -o page.html --dims 16 --budget 20s --csv page.csv -q || exit 1

failed=0
bad() { echo "$*"; failed=1; }
browse() { # what remains of the page after its scripts ran
    timeout 60 chromium --headless --no-sandbox --disable-gpu --user-data-dir="$folder/profile" \
        --hide-scrollbars "$@" 2>browser.log
}

ask='<script>document.title="asked "+document.querySelectorAll("button").length+" "+(document.documentElement.scrollWidth-innerWidth)+" "+performance.getEntriesByType("resource").filter(function(e){return e.name.indexOf("data:")!==0}).length</script>'
for theme in light dark; do
    sed -e "s|<html lang=\"en\">|<html lang=\"en\" data-theme=\"$theme\">|" -e "s|</body>|$ask</body>|" \
        page.html >$theme.html
done
done_count=$(tail -n +2 page.csv | sed 's/"[^"]*"//' | awk -F, '$3 == "yes"' | wc -l)
for size in 1400,900 500,900; do
    browse --window-size=$size --dump-dom "file://$folder/light.html" >dom
    said=$(sed -n 's/.*<title>asked \([^<]*\)<.*/\1/p' dom | head -n 1)
    [ -n "$said" ] || { echo "skip: chromium does not start" >&2; exit 77; }
    # a button for each command, and one for the command that makes the file
    set -- $said
    [ "$1" = $((done_count + 1)) ] || bad "$size: $1 buttons for $done_count commands"
    [ "$2" -le 0 ] || bad "$size: $2 pixels wider than the window"
    [ "$3" = 0 ] || bad "$size: $3 other files were asked for"
done
for theme in light dark; do
    browse --window-size=900,1200 --screenshot="$folder/$theme.png" "file://$folder/$theme.html" \
        >/dev/null
    [ -s $theme.png ] || bad "$theme: no picture"
done
cmp -s light.png dark.png && bad "dark is light"
exit $failed
