# Views that are kept, films of them, and cameras in words.
cubewright version --features | grep -q '^window *yes' || { echo "this build has no window" >&2; exit 77; }
cubewright version --features | grep -q '^gl *yes' || { echo "this build has no OpenGL" >&2; exit 77; }
cubewright make ct-head -o h.nrrd --dims 24 --type i16 -q
view() {
    cubewright view h.nrrd -q --hidden --size 320x240 "$@" || echo "exit $?"
}
alike() {
    cmp "$1" "$2" && echo "$1 is $2"
}
differ() {
    cmp "$1" "$2" >/dev/null && echo "$1 is $2"
}

# What was seen before comes back; so does what was seen after it.
echo "earlier views"
view --exec 'camera front; screenshot a.png; orbit 40; screenshot b.png; pan 3 3; camera-back; screenshot c.png; camera-back; screenshot d.png
    camera-forward; screenshot e.png; dolly 2; camera-forward' 2>&1
alike a.png d.png
alike b.png c.png
alike b.png e.png
view --exec 'camera front; mouse 60 60; press; mouse 90 60; mouse 99 60; lift; print camera; key Alt+Left; key Alt+Left; key Alt+Left; print message; print camera' |
    grep -e message -e eye

echo "bookmarks"
view --exec 'iso 300; camera front; bookmark; orbit 40; iso off; mode mip; bookmark "its side"; screenshot side.png; go-to "view 1"; print iso;
    go-to "its side"; screenshot again.png; save-state s.txt; remove-bookmark "view 1"; go-to "view 1"' 2>&1
alike side.png again.png
grep -c '^bookmark' s.txt
cubewright view -q --hidden --size 320x240 --run s.txt --exec 'go-to "view 1"; print iso; go-to "its side"; screenshot third.png'
alike side.png third.png
cubewright view h.nrrd -q --hidden --size 640x900 --exec 'click "Views and film"; click "Keep this view"; orbit 30; click "Keep this view"; wait; click Play; wait; print camera; save-state t.txt' | grep eye
grep -c '^bookmark' t.txt

echo "films"
cat >film.txt <<'FILM'
# seconds and commands
0    camera front; mode mip
0.5  camera right; window 0 300
1    camera 30,20; opacity 0.5
FILM
view --film film.txt --fps 4 -o 'f-{frame:02d}.png'
ls f-*.png
view -o front.png --camera front --mode mip
view -o right.png --camera right --mode mip
alike f-00.png front.png
alike f-02.png right.png
differ f-00.png f-01.png
differ f-01.png f-02.png
view --film film.txt --fps 4 -o 'g-{frame:02d}.png'
alike f-01.png g-01.png
view --exec 'camera front; mode mip; bookmark; camera right; bookmark; film-seconds 0.5; toggle panels off; film bookmarks "b-{frame}.png" 4; save-film b.txt; print camera' | grep eye
cmp -s b-0.png f-00.png || echo "b-0.png is seen from farther: panels were beside the first view"
view --mode mip --film b.txt --fps 4 -o 'c-{frame}.png'
for n in 0 1 2; do
    alike b-$n.png c-$n.png
done

echo "wrong films"
view --film film.txt
view --film film.txt -o a.png
view --film none.txt -o 'a{frame}.png'
view --fps 3 -o a.png
view --film film.txt --fps 0 -o 'a{frame}.png'
printf '0 camera front\n0 camera right\n' >twice.txt
view --film twice.txt -o 'a{frame}.png'
printf '0 camera front\n' >single.txt
view --film single.txt -o 'a{frame}.png'
printf '0 camera front\n\n1 camera sideways\n' >bad.txt
view --film bad.txt -o 'a{frame}.png'
printf 'camera front\n' >time.txt
view --film time.txt -o 'a{frame}.png'
view --exec 'bookmark; film bookmarks "a{frame}.png"'
view --exec 'save-film a.txt'

# A camera in words gives the picture that was copied.
echo "words"
view --exec 'mode mip; orbit 40 10; roll 20; dolly 1.3; print command; toggle panels off; screenshot w.png' >line
sed 's/--camera.*/--camera ...  &/' line | cut -c 1-60
eval "$(sed 's/^cubewright view h.nrrd/view/' line) -o v.png"
alike w.png v.png
cubewright render h.nrrd -q -o r.png --camera 'eye 0,-500,0 to 0,0,0 fov 30' --mode mip --size 64x64 && echo fine
for camera in 'eye 0,-500,0 to 0,0,0' 'eye 0,0,0 to 0,0,0 fov 30' 'eye 0,-500 to 0,0,0 fov 30' 'eye 0,-500,0 to 0,0,0 fov -3' 'eye 0,-500,0 to 0,0,0 up 0,1,0 fov 30' \
    'eye 0,-500,0 to 0,0,0 fov 30 or so'; do
    cubewright render h.nrrd -q -o r.png --mode mip --camera "$camera" || echo "exit $?"
done
