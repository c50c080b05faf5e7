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
slices ct
head -c -9 ct/3.dcm > cut && mv cut ct/3.dcm
cubewright info ct
cubewright info ct --json | sed -n '/"finding"/,$p'
cubewright extract ct --iso -800 -o no.stl -q
echo $?
cubewright extract ct --iso -800 -o no.stl --skip-damaged
echo $?
cubewright extract ct --iso -800 -o mended.stl --skip-damaged --gaps interpolate
ls
# folders in a batch: {stem} is the name, with or without a slash behind it
mkdir sets sets/a.1 sets/b.2
slices sets/a.1
slices sets/b.2
cubewright extract 'sets/*/' --iso -800 -o '{parent}-{stem}.stl' --batch -q
cubewright extract 'sets/*' --iso -800 -o '{stem}.stl' --batch -q
ls -- *[ab].stl
