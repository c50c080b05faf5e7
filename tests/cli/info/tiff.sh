# Numbered slices: a folder, a pattern, and one missing.
cubewright formats | grep '^tiff' | grep -qv 'not in this' || { echo "this build reads no TIFF" >&2; exit 77; }
# slice NUMBER FILE: so many planes into a volume of 24 x 24 floats, one page of one strip
slice() {
    {
        printf 'II*\000\010\000\000\000\010\000'
        printf '\000\001\003\000\001\000\000\000\030\000\000\000' # ImageWidth 24
        printf '\001\001\003\000\001\000\000\000\030\000\000\000' # ImageLength
        printf '\002\001\003\000\001\000\000\000\040\000\000\000' # BitsPerSample 32
        printf '\006\001\003\000\001\000\000\000\001\000\000\000' # black is 0
        printf '\021\001\004\000\001\000\000\000\156\000\000\000' # StripOffsets 110
        printf '\026\001\003\000\001\000\000\000\030\000\000\000' # RowsPerStrip
        printf '\027\001\004\000\001\000\000\000\000\011\000\000' # StripByteCounts 2304
        printf '\123\001\003\000\001\000\000\000\003\000\000\000' # SampleFormat: floats
        printf '\000\000\000\000'
        tail -c +$((353 + 2304 * $1)) ball.nii | head -c 2304
    } >"$2"
}
cubewright make sphere -o ball.nii --dims 24 -q
mkdir scan
for k in $(seq 0 23); do
    slice "$k" "scan/cut$((k + 1)).tif"
done
cubewright extract ball.nii --spacing 2,2,2mm --iso 1 -o ball.stl --local -q
cubewright info scan
for path in scan 'scan/*.tif' 'scan/cut?*'; do
    cubewright extract "$path" --spacing 2,2,2mm --iso 1 -o scan.stl --local -q &&
        tail -c +85 ball.stl >a && tail -c +85 scan.stl >b && cmp a b && echo same
done
cubewright info scan/cut9.tif | sed 2q
echo "a note" >scan/note.txt
rm scan/cut9.tif
cubewright extract scan --iso 1 -o no.stl
echo $?
cubewright extract scan --iso 1 -o made.stl --gaps interpolate
cubewright extract scan --iso 1 -o short.stl --gaps allow
head -c 2000 scan/cut10.tif >scan/cut9.tif
cubewright extract scan --iso 1 -o no.stl -q
echo $?
ls
