#!/bin/sh
# A window on a screen, used from outside as people do: sh screen.sh BIN_FOLDER. The screen is
# Xvfb's; xdotool moves the mouse and types; what changed is seen in pictures (F12) and sessions
# (Ctrl+S) that the window writes. 77 when something for that is missing.
set -u
PATH=$1:$PATH
export PATH
for tool in xvfb-run xdotool import xauth; do
    command -v $tool >/dev/null || { echo "skip: no $tool" >&2; exit 77; }
done
cubewright version --features | grep -q '^window *yes' || { echo "skip: no window" >&2; exit 77; }
cubewright version --features | grep -q '^gl *yes' || { echo "skip: no OpenGL" >&2; exit 77; }
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../support/wait.sh"
if [ -z "${WINDOW_TEST_SCREEN:-}" ]; then
    WINDOW_TEST_SCREEN=1 exec xvfb-run -a -s "-screen 0 1000x800x24 -noreset" sh "$here/screen.sh" "$1"
fi

failed=0 program=
folder=$(mktemp -d)
trap '[ -z "$program" ] || kill "$program" 2>/dev/null; rm -rf "$folder"' EXIT
cd "$folder" || exit 1

fail() {
    echo "$*"
    failed=1
}

is_written_or_over() {
    [ -s "$1" ] || is_over "$program"
}

# wait_for FILE [KEY]: until it is there: that takes what it takes. The key asks for it.
wait_for() {
    [ -z "${2:-}" ] || xdotool key --window "$window" "$2"
    wait_until is_written_or_over "$1"
    [ -s "$1" ] || { fail "no $1"; return 1; }
}

# start ARGUMENTS...: opens a window, and waits for its first picture.
start() {
    rm -f ready.png
    cubewright view --size 640x480 --no-lit --no-preintegration "$@" --exec 'wait; capture ready.png' >out 2>err &
    program=$!
    wait_for ready.png || { cat out err; exit 1; }
    window=$(xdotool search --sync --onlyvisible --pid $program | head -n 1)
    [ -n "$window" ] || window=$(xdotool search --sync --onlyvisible --name cubewright | head -n 1)
    xdotool windowfocus --sync "$window" 2>/dev/null
    xdotool mousemove --window "$window" 5 470
}

# The session is written: what WORDS... changed is in it.
shows() {
    rm -f cubewright-state.txt
    wait_for cubewright-state.txt ctrl+s || return 1
    grep -q -e "$1" cubewright-state.txt || { fail "no '$1' after $2:"; cat cubewright-state.txt; }
}

# Keys that come while a file is read are not heard: Ctrl+S is pressed again now and then.
has_session_or_is_over() {
    if [ -s cubewright-state.txt ]; then
        grep -q -e "$1" cubewright-state.txt && return
        rm cubewright-state.txt
        asked=0
    fi
    [ $((asked % 60)) != 0 ] || xdotool key --window "$window" ctrl+s
    asked=$((asked + 1))
    is_over "$program"
}

# shows_after_reading WORDS WHAT: as shows, of a file that the window may still be reading. In the end a
# picture is taken: all that was pressed before it has been heard then.
shows_after_reading() {
    rm -f cubewright-state.txt
    asked=0
    wait_until has_session_or_is_over "$1" || { fail "no '$1' after $2"; return 1; }
    is_over "$program" && { fail "no window after $2"; return 1; }
    picture read.png
}

# picture NAME: as F12 writes it.
picture() {
    rm -f cubewright-*.png
    wait_for cubewright-001.png F12 && mv cubewright-001.png "$1"
}

# expect NAME COMMANDS...: what is seen now is what these make of a window that nobody sees.
expect() {
    name=$1
    shift
    picture "$name.png" || return 1
    cubewright view h.nrrd -q --hidden --size 640x480 --no-lit --no-preintegration --exec "$*; screenshot $name-hidden.png"
    png_near "$name.png" "$name-hidden.png" 0.3 48 >near || fail "$(cat near)"
}

# place LABEL X Y: pixels of a place on a widget, out of a window that nobody sees.
place() {
    cubewright view h.nrrd -q --hidden --size 640x480 --no-lit --no-preintegration --exec "mode mip; wait; place '$1'" |
        awk -v x="$2" -v y="$3" '{ printf "%d %d\n", $2 + x * $4, $3 + y * $5 }'
}

# What is moved, pressed and lifted waits in order until the window takes it. The pauses are those of
# people; without them the same is seen.
move() {
    xdotool mousemove --window "$window" "$1" "$2"
    sleep 0.1
}

# drag X0 Y0 X1 Y1 [BUTTON]
drag() {
    move "$1" "$2"
    xdotool mousedown "${5:-1}"
    sleep 0.1
    move $((($1 + $3) / 2)) $((($2 + $4) / 2))
    move "$3" "$4"
    xdotool mouseup "${5:-1}"
    sleep 0.1
}

cubewright make ct-head -o h.nrrd --dims 40 --type i16 -q
cubewright make torus -o 't #1 ü.nrrd' --dims 24 -q
printf 'NRRD0004\nnonsense' >broken.nrrd
start h.nrrd

# What the window shows is what it says it shows.
import -window "$window" screen.png
png_near screen.png ready.png 0.5 255 >near || fail "$(cat near)"

xdotool key --window "$window" m
shows '^mode mip' "key M"
expect mip 'mode mip'
drag 160 240 260 200
expect orbit 'mode mip; orbit -40 -16'
xdotool key --window "$window" 3
move 160 240
xdotool click 4
xdotool click 4
expect wheel 'mode mip; camera right; dolly 1.10517; dolly 1.10517'
xdotool key --window "$window" ctrl+1
expect back 'mode mip; camera back'

# A slider.
slide_from=$(place Shift 0.5 0.5) slide_to=$(place Shift 0.75 0.5)
# shellcheck disable=SC2086
drag $slide_from $slide_to
shows '^shift [45][0-9][0-9]' "the slider"
xdotool key --window "$window" ctrl+z
shows '^mode mip' "undo"
grep '^shift' cubewright-state.txt && fail "a shift after undo"
# Sizes, and what is written into a field.
xdotool windowsize --sync "$window" 700 600
picture large.png
[ "$(od -A n -t u1 -j 18 -N 6 large.png)" = "$(od -A n -t u1 -j 18 -N 6 back.png)" ] && fail "the picture kept its size"
xdotool windowsize --sync "$window" 640 480
xdotool key --window "$window" h
picture help.png
xdotool key --window "$window" Escape

# Files are dropped: with blanks and such in their names; a damaged one is told of, and no end.
xdnd drop "$window" 100 100 "$folder/t #1 ü.nrrd" || fail "nothing was dropped"
shows_after_reading '^open .*t #1 ü.nrrd' "a drop"
xdnd drop "$window" 100 100 "$folder/broken.nrrd" || fail "the damaged one was not dropped"
shows_after_reading '^open .*t #1 ü.nrrd' "a damaged file"
xdnd drop "$window" 100 100 "$folder/h.nrrd" || fail "nothing was dropped after a damaged one"
shows_after_reading '^open .*h.nrrd' "a drop"

# The end: Ctrl+Q, and in another window what a window manager sends.
xdotool key --window "$window" ctrl+q 2>/dev/null # it may be gone before the key comes up
wait $program || fail "exit code $? after Ctrl+Q: $(cat err)"
xdotool keyup q keyup ctrl # else it goes down again in the next window

# A point of the transfer function, in the middle of the curve, goes up and to the right.
cat >tf.json <<'JSON'
{"schema": "cubewright-transfer-1", "colors": [[-1000, "#000000"], [995, "#ffffff"]],
 "opacities": [[-500, 0], [-2.5, 0.5], [500, 1]]}
JSON
start h.nrrd --tf tf.json
point=$(place Curve 0.5 0.5) point_to=$(place Curve 0.6 0.25)
picture before.png
# shellcheck disable=SC2086
drag $point $point_to
shows '^tf .*"opacities": \[\[-500.0, 0.0\], \[[12][0-9][0-9][.].*, 0.7' "a point"
picture point.png
png_near before.png point.png 0.3 48 >near && fail "the point changed nothing"
xdotool key --window "$window" ctrl+z
picture undone.png
cmp before.png undone.png || fail "undo did not bring the point back"
xdnd close "$window"
wait $program || fail "exit code $? after closing: $(cat err)"
program=
exit $failed
