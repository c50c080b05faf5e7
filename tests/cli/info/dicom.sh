# A series in a folder: listed, chosen, and stopped at where slices are missing.
cubewright formats | grep '^dicom' | grep -qv 'not in this' || { echo "this build reads no DICOM" >&2; exit 77; }
mkdir ct
slices ct
cubewright info ct
cubewright extract ct --iso -800 -o ball.stl
cubewright extract ct/3.dcm --iso -800 -o same.stl -q && cmp ball.stl same.stl && echo same
cubewright extract 'ct/*.dcm' --iso -800 -o same.stl -q --no-sandbox && cmp ball.stl same.stl && echo same
rm ct/2.dcm
echo "a note" > ct/note.txt
cubewright info ct
cubewright extract ct --iso -800 -o no.stl
echo $?
cubewright extract ct --iso -800 -o made.stl --gaps interpolate --json - | grep -A 3 '"notes"'
cubewright extract ct --iso -800 -o short.stl --gaps allow
cubewright render ct -o none.png
cubewright extract ct --iso -800 -o no.stl --series 9
echo $?
cubewright extract ct --iso -800 -o no.stl --reader nrrd
echo $?
mkdir empty
cubewright info empty
echo $?
cubewright info 'ct/*.nothing'
echo $?
head -c 700 ct/4.dcm > ct/5.dcm
cubewright extract ct --iso -800 -o no.stl -q
echo $?
ls
