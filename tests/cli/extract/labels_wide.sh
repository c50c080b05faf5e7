# Numbers of labels of 64 bits, below 0, and with noise: they are kept in names, tables and files.
cubewright make labels/cells --dims 20 --labels 4 --type u8 -o cells.nii -q
# writes the map anew: $1 is the type, and the others the bytes of each label's number in octal
map() {
  printf 'NRRD0004\ntype: %s\ndimension: 3\nsizes: 20 20 20\nencoding: raw\nendian: little\n\n' "$1"
  shift
  tail -c 8000 cells.nii | od -An -v -tu1 -w20 | IDS="$*" awk \
    'BEGIN { split(ENVIRON["IDS"], id, " ") } { for (n = 1; n <= NF; n++) printf "%s", id[$n + 1]; print "" }' |
    while read -r row; do printf "$row"; done
}
zero='\000\000\000\000\000\000\000\000'
map uint64 $zero '\005\000\000\000\000\000\000\000' '\000\000\000\000\001\000\000\000' \
  '\133\000\362\113\135\000\000\012' '\377\377\377\377\377\377\377\377' >wide.nrrd
cat >names.csv <<'END'
LabelValue,Name,Color_R,Color_G,Color_B
18446744073709551615,Last,0,0,255
5,Glia,0,255,0
99,Absent,1,2,3
END
cubewright extract wide.nrrd --labels all --names names.csv -o wide.ply --table wide.csv
cut -d, -f1,2,8 wide.csv
strings wide.ply | grep label
cubewright extract wide.nrrd --labels all --names wide.csv -o again.ply --table again.csv -q
cmp wide.csv again.csv && echo same
# slice by slice, as from memory
cubewright extract wide.nrrd --labels all --names names.csv -o wide.obj -q
cubewright extract wide.nrrd --labels all --names names.csv -o stream.obj -q --stream always
grep -v mtllib wide.obj >a && grep -v mtllib stream.obj >b && cmp a b && echo same
grep usemtl wide.obj
# chosen by number and by name, and a file each
cubewright extract wide.nrrd --labels 4294967296,last,99,7-8,-4 --names names.csv -o 'one_{label}_{name}.stl' -q
ls one_*
cubewright extract wide.nrrd --labels all --shared-faces --names names.csv -o faces.vtp -q
grep -a -c -e 'type="UInt64" Name="BoundaryLabels"' -e '^18446744073709551615$' -e 'Name="label_name"' faces.vtp
cubewright info wide.nrrd --names names.csv | grep -e values -e Last -e labels
cubewright info wide.nrrd --json | grep -A3 '"range"'
cubewright extract wide.nrrd --iso 3 -o bad.stl; echo "exit $?"
# below 0
map short '\000\000' '\373\377' '\377\377' '\001\000' '\002\000' >below.nrrd
cubewright extract below.nrrd --labels=-5,2 -o 'below_{label}.stl' -q
ls below_*
cubewright extract below.nrrd --labels all -o bad.obj -q --json - | grep '"label"'
# with noise: -0.02 for the background, and 1.04
map float '\012\327\243\274' '\270\036\205\077' '\000\000\000\100' '\000\000\100\100' '\000\000\200\100' >noise.nrrd
cubewright extract noise.nrrd --labels all -o bad.stl; echo "exit $?"
cubewright extract noise.nrrd --labels all -o noise.stl --round
cubewright extract noise.nrrd --labels all -o stream.stl --round --stream always -q
map 'unsigned char' '\000' '\001' '\002' '\003' '\004' >small.nrrd
cubewright extract small.nrrd --labels all -o cells.stl -q
cmp noise.stl cells.stl && cmp stream.stl cells.stl && echo same
cubewright extract cells.nii --iso 1 --round -o bad.stl; echo "exit $?"
