# What engrave refuses; nothing is written then.
printf 'OFF\n4 4 0\n0 0 0\n9 0 0\n0 9 0\n0 0 9\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n' >corner.off
printf 'OFF\n4 3 0\n0 0 0\n9 0 0\n0 9 0\n0 0 9\n3 0 2 1\n3 0 1 3\n3 0 3 2\n' >open.off
cubewright make sphere -o s.nrrd --dims 16 -q
try() {
    cubewright "$@" -q
    echo "$? $*"
}
try engrave corner.off -o x.stl
try engrave corner.off --text A
try engrave corner.off --text '' -o x.stl
try engrave corner.off --text 'Größe' -o x.stl
try engrave corner.off --text '{label}' -o x.stl
try engrave corner.off --text '{nam}' -o x.stl
try engrave corner.off --text A --size 0mm -o x.stl
try engrave corner.off --text A --size 5 -o x.stl
try engrave corner.off --text A --size 6mm -o x.stl
try engrave corner.off --text 'no room for this' --size 2mm -o x.stl
try engrave corner.off --text A --size 1mm --depth 9mm -o x.stl
try engrave corner.off --text A --size 1mm --stroke 0.5mm -o x.stl
try engrave corner.off --text A --at 1,2 -o x.stl
try engrave corner.off --text A --at 1,1,0 --direction 0,0,0 -o x.stl
try engrave corner.off --text A --size 1mm --at 20,20,1 --direction 0,0,-1 -o x.stl
try engrave open.off --text A -o x.stl
try engrave corner.off --text A -o corner.off
try extract s.nrrd --iso 0 --engrave A --open -o x.stl
try extract s.nrrd --iso 0 --engrave A --stream always -o x.stl
try extract s.nrrd --iso 0 --engrave '{label}' -o x.stl
ls -A
