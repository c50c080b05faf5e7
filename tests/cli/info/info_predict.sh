# What info predicts of extract is what extract makes, counted in memory or slice by slice.
set -e
cubewright make gyroid -o g.nrrd --dims 70x60x50 --type i16 --noise 0.2 --seed 3 -q
head -c 64000000 /dev/zero >big.raw
printf '\377' | dd of=big.raw bs=1 seek=32200200 conv=notrunc 2>/dev/null
take() { # KEY FILE: the first number of that key
    sed -n "s/.*\"$1\": \([0-9]*\).*/\1/p" "$2" | tail -1
}
compare() { # NAME VOLUME OPTIONS...
    name=$1 volume=$2
    shift 2
    cubewright info "$volume" "$@" --json | sed -n '/"predictions"/,$p' >info.json
    for format in ply stl; do
        cubewright extract "$volume" "$@" -o "${volume%.*}.$format" -q
        [ "$(take ${format}_bytes info.json)" = "$(($(wc -c <"${volume%.*}.$format")))" ]
    done
    cubewright extract "$volume" "$@" -o "${volume%.*}.ply" --json made.json -q
    sed -n '/"mesh": {/,/}/p' made.json >mesh.json
    [ "$(take triangles info.json)" = "$(take triangles mesh.json)" ]
    [ "$(take vertices info.json)" = "$(take vertices mesh.json)" ]
    echo "$name: $(take triangles info.json) triangles, as predicted; $(grep streamed info.json | tr -d ' ,')"
}
compare "in memory" g.nrrd --iso 100
compare "a crop" g.nrrd --iso 100 --crop 5:60,3:50,10:40
compare "slice by slice" big.raw --raw dims=400x400x400,type=u8 --iso 100 --memory 40M
# a PLY holds its name, so a longer one takes as many bytes more
cubewright info g.nrrd --iso 100 --json >info.json
cubewright extract g.nrrd --iso 100 -o "$(sed -n 's/.*"stem": "\(.*\)".*/\1/p' info.json)longer.ply" -q
[ "$(($(take ply_bytes info.json) + 6))" = "$(($(wc -c <glonger.ply)))" ] && echo "6 bytes more"
# --levels gives the size of the STL that extract makes at a level
cubewright info g.nrrd --levels >levels.txt
cubewright extract g.nrrd --iso otsu -o otsu.stl -q
grep -c "otsu .*STL $(wc -c <otsu.stl | awk '{ printf "%.1f MB", $1 / 1e6 }')" levels.txt
compare "denoised" g.nrrd --iso 100 --denoise gauss:1vox
cubewright info g.nrrd --iso 100 --denoise aniso | grep memory
# several isovalues, one of them without a surface
cubewright info g.nrrd --iso 100,-2000 | grep -A3 extract
cubewright info g.nrrd --iso 100,99999 >two.txt || echo "exit $?"
grep "iso 99999" two.txt
# what is not predicted
cubewright info g.nrrd g.nrrd --iso 100 || echo "exit $?"
cubewright info big.raw --raw dims=400x400x400,type=u8 --iso 100 --memory 16M || echo "exit $?"
# GLB states the numbers of its box, so that its size is an estimate
cubewright extract g.nrrd --iso 100 -o g.glb -q 2>no.txt || exit 0
cubewright info g.nrrd --iso 100 --json >info.json
glb=$(($(wc -c <g.glb))) about=$(take glb_bytes info.json)
[ $((glb - about)) -lt 500 ] && [ $((about - glb)) -lt 500 ]
