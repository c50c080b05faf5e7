#!/bin/sh
# The page of report in Chromium: sh report.sh BIN_FOLDER. Its scripts have to run: each command gets
# a button, tables are sorted, a point marks its row, an axis is chosen, the view draws its meshes.
# Nothing may be wider than the window, wide or narrow, dark and light must differ, texts must stand
# out from what is behind them, and it must not reach for any other file. 77 when Chromium is not
# there.
set -u
tests=$(cd "$(dirname "$0")" && pwd)
PATH=$1:$PATH
export PATH
. "$tests/../support/wait.sh"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
command -v chromium >/dev/null || { echo "skip: chromium is not installed" >&2; exit 77; }
cubewright report gyroid -o page.html --dims 16 --budget ${limit_s}s --csv page.csv -q || exit 1

failed=0
bad() { echo "$*"; failed=1; }
browse() { # what remains of the page after its scripts ran
    timeout $limit_s chromium --headless --no-sandbox --enable-unsafe-swiftshader --use-angle=swiftshader \
        --virtual-time-budget=20000 --user-data-dir="$folder/profile" \
        --hide-scrollbars "$@" 2>browser.log
}

for theme in light dark; do
    {
        # frames come by the clock of the test, which runs faster than the screen
        sed -e "s|<html lang=\"en\">|<html lang=\"en\" data-theme=\"$theme\">|" \
            -e "s|<style>|<script>requestAnimationFrame = (f) => setTimeout(f, 5)</script><style>|" page.html
        echo '<script>'
        cat "$tests/report_ask.js"
        echo '</script>'
    } >$theme.html
done
done_count=$(tail -n +2 page.csv | sed 's/"[^"]*"//' | awk -F, '$3 == "yes"' | wc -l)
advice=$(grep -c '<strong>For ' page.html)
for look in light:1400,900 light:500,900 dark:1400,900; do
    size=${look#*:}
    browse --window-size=$size --dump-dom "file://$folder/${look%:*}.html" >dom
    said=$(sed -n 's/.*<title>asked \([^<]*\)<.*/\1/p' dom | head -n 1)
    [ -n "$said" ] || { echo "skip: chromium does not start" >&2; exit 77; }
    # a button for each command, for those of the advice, and for the one that makes the file
    set -- $said
    [ "$1" = $((done_count + advice + 1)) ] || bad "$look: $1 buttons for $done_count commands"
    [ "$2" -le 0 ] || bad "$look: $2 pixels wider than the window"
    [ "$3" = 0 ] || bad "$look: $3 other files were asked for"
    [ "$4 $5 $6 $7 $8" = "ascendingtrue descendingtrue row:true dot:true axis:1" ] ||
        bad "$look: $4 $5 $6 $7 $8"
    [ "$9" = drawn:true ] || bad "$look: the view: $9"
    shift 9
    [ "$1" = last:true ] || bad "$look: the last mesh: $1"
    awk "BEGIN {exit !($2 >= 4.5)}" || bad "$look: contrast $2"
done
for theme in light dark; do
    browse --window-size=900,1200 --screenshot="$folder/$theme.png" "file://$folder/$theme.html" \
        >/dev/null
    [ -s $theme.png ] || bad "$theme: no picture"
done
# without WebGL the view is left out, and said
browse --window-size=900,1200 --disable-3d-apis --dump-dom "file://$folder/page.html" >dom
grep -q 'cannot draw in three' dom && grep -q 'class="view3d" hidden' dom || bad "no word where there is no WebGL"
cmp -s light.png dark.png && bad "dark is light"
exit $failed
