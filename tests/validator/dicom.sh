#!/bin/sh
# DICOM in every transfer syntax that other people's tools write: sh dicom.sh BIN_FOLDER SLICES,
# where SLICES is the program that writes the plain series. Each must give the same surface, and
# none may give away the patient. 77 when neither DCMTK's tools nor GDCM's are there.
set -u
PATH=$1:$PATH
slices=$2
failed=0
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
command -v dcmconv >/dev/null || command -v gdcmconv >/dev/null ||
    { echo "skip: neither dcmtk nor libgdcm-tools is installed" >&2; exit 77; }
cubewright formats | grep '^dicom' | grep -qv 'not in this' ||
    { echo "skip: this build reads no DICOM" >&2; exit 77; }

mkdir plain
"$slices" plain
cubewright extract plain --iso -800 --name ball -o plain.ply --json plain.json 2>said || exit 1
cubewright info plain >>said 2>&1
cubewright info plain --json >>said 2>&1

# same NAME COMMAND...: the command makes a slice of another
same() {
    name=$1
    shift
    command -v "$1" >/dev/null || return 0
    mkdir "$name"
    for slice in plain/*.dcm; do
        "$@" "$slice" "$name/${slice##*/}" >log 2>&1 || { cat log; failed=1; }
    done
    cubewright extract "$name" --iso -800 --name ball -o "$name.ply" 2>>said &&
        cmp plain.ply "$name.ply" || { echo "$name: another surface"; failed=1; }
}
same implicit dcmconv +ti
same big_endian dcmconv +tb
same deflated dcmconv +td
same bare dcmconv -F
same rle dcmcrle
same jpeg_lossless dcmcjpeg
same jpeg_lossless_6 dcmcjpeg +el
same jpeg_ls dcmcjpls
same gdcm_rle gdcmconv --rle
same gdcm_jpeg gdcmconv --jpeg
same gdcm_jpeg_ls gdcmconv --jpegls
same gdcm_jpeg_2000 gdcmconv --j2k

# names, numbers and dates of the file stand in nothing that we wrote
for secret in DOE JANE SECRET 4711 19700102; do
    if grep -l "$secret" said plain.json plain.ply; then
        echo "$secret was given away"
        failed=1
    fi
done
exit $failed
