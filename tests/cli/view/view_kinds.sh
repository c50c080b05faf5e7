# Whatever info reads opens in the window: by name, by folder and by drop. The seeds of the fuzz
# targets are files of every kind, small and odd; made volumes and meshes are of those we write.
. "$TESTS/support/wait.sh"
cubewright version --features | grep -q '^window *yes' || { echo "this build has no window" >&2; exit 77; }
cubewright version --features | grep -q '^gl *yes' || { echo "this build has no OpenGL" >&2; exit 77; }
cubewright make torus -o t.nrrd --dims 16 -q
for name in t.nii t.nii.gz t.mha; do
    cubewright make torus -o $name --dims 16 -q
done
for name in t.ply t.stl t.obj t.off t.glb t.gltf t.3mf t.vtp; do
    cubewright extract t.nrrd --iso 0 -o $name -q || rm -f $name
done

# drop_all <LIST: each in turn on one window; what could not be opened is named, with the reason.
drop_all() {
    while read -r path; do
        printf "drop '%s'; wait; print open; print message; key M; key ]; key Q; wait\n" "$path"
    done >drops.txt
    cubewright view -q --hidden --size 420x120 --no-lit --no-preintegration --run drops.txt || echo "exit $?"
}

# expect_all LIST OUT: every one was open.
expect_all() {
    sed 's,.*/,,' "$1" >asked
    sed -n 's/^open //p' "$2" >open
    cmp asked open >/dev/null && return
    diff asked open
    grep message "$2"
}

echo "made"
ls t.* | grep -v -e '\.raw' -e '\.zraw' -e '\.bin' -e '\.img' >made
drop_all <made >said 2>why
expect_all made said
cat why
wc -l <made

echo "odd"
for file in "$TESTS"/fuzz/corpus/fuzz_*/*; do
    case $file in
    *transfer*) ;;
    *) # not of several series, of which one has to be chosen
        timeout $limit_s cubewright info "$file" -q >info 2>&1 && [ "$(grep -c '^  series' info)" -lt 2 ] && echo "$file" ;;
    esac
done >odd
drop_all <odd >said 2>why
expect_all odd said
[ "$(wc -l <odd)" -gt 50 ] || echo "too few: $(wc -l <odd)"
cat why

# By name, and by folder: what is in it is a series.
echo "names and folders"
while read -r path; do
    cubewright view "$path" -q --hidden --size 420x120 --exec 'print triangles' -o p.png >said || echo "exit $?: $path"
done <made
mkdir steps
for n in 1 2 3; do
    cubewright make sphere -o steps/s$n.nrrd --dims 1$n -q
done
cubewright view steps -q --hidden --size 420x120 --exec 'print open; print step; step next; print step'
cubewright view -q --hidden --size 420x120 --exec 'drop steps; print step; open t.nrrd; next; print open; previous; print open'
