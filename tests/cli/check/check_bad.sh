# Meshes and options that cannot be: clear words, the right exit code, nothing written.
try() {
    cubewright check "$@"
    echo "exit $?" >&2
}
printf 'OFF\n3 1 0\n0 0 0\n1 0 0\n0 nan 0\n3 0 1 2\n' >nan.off
printf 'OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n' >index.off
printf 'OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n' >none.off
printf 'OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n' >one.off
printf 'OFF\n3 2 0\n0 0 0\n0 0 0\n0 0 0\n3 0 1 2\n3 0 0 0\n' >point.off
try nan.off
try index.off
try none.off -q
try none.off --source absent.nrrd --iso 3 -q
try one.off -q
try point.off -q
try absent.off
try one.off --iso 3
try one.off --source s.nrrd
try one.off --tolerance 1mm
try one.off --tolerance 1mm,2mm,3mm --reference one.off
try one.off --tolerance 0.1vox --reference one.off
try one.off --tolerance 0% --reference one.off
try one.off --defects x.stl
try one.off --defects one.off
try one.off --json none.off --reference none.off
try one.off --json one.off
try one.off --profile prnt
try one.off --reference none.off -q
ls
