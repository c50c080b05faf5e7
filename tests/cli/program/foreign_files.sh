# Files of other programs are named, with what converts them, by commands for volumes and for meshes.
try() {
    cubewright extract "$1" --iso 1 -o x.stl -q
    echo "extract $1: $?"
    cubewright convert "$1" -o x.stl -q
    echo "convert $1: $?"
}
mkdir scan && printf 'not a scan' >scan/1.dcm
# a zip archive of one stored file, and one that is a package
zip_of() {
    crc='\000\000\000\000'
    printf 'PK\003\004\024\000\000\000\000\000\000\000\000\000'"$crc"'\000\000\000\000\000\000\000\000'"\\$2"'\000\000\000%s' "$1"
    printf 'PK\001\002\024\000\024\000\000\000\000\000\000\000\000\000'"$crc"'\000\000\000\000\000\000\000\000'"\\$2"'\000\000\000\000\000\000\000\000\000\000\000\000\000\000\000\000\000%s' "$1"
    printf 'PK\005\006\000\000\000\000\001\000\001\000'"\\$3"'\000\000\000'"\\$4"'\000\000\000\000\000'
}
zip_of scan/1.dcm 012 070 050 >scan.zip
try scan.zip
printf '\377\376v\000 \0000\000 \0000\000\n\000' >text.obj
try text.obj
printf '\211HDF\r\n\032\n' >data.h5
try data.h5
printf 'mrtrix image\ndim: 1\n' >fibres.mif
try fibres.mif
printf '# AmiraMesh BINARY 2.1\n' >labels.am
try labels.am
printf 'nothing' >brain.mnc
try brain.mnc
printf 'ISO-10303-21;\n' >part.step
try part.step
printf 'Kaydara FBX Binary' >hand.fbx
try hand.fbx
ls x.stl 2>/dev/null
exit 0
