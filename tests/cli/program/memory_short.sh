# Where memory is short, that is what is said (8), whichever library is the first to notice:
# threads that the system does not give, and modules whose constructors end their process.
cubewright make sphere -o s.nrrd --dims 16 -q
try() {
    limit=$1
    shift
    (ulimit -v "$limit"; cubewright "$@" -q >/dev/null 2>err)
    code=$?
    [ $code = 0 ] || [ $code = 8 ] || { echo "$limit kB: $code: $*"; cat err; }
}
try 300000 extract s.nrrd --iso 0 -o m.stl -t 500
cubewright extract s.nrrd --iso 0 -o s.glb -q 2>/dev/null && for limit in 12000 14000 16000 18000 20000 24000 28000; do
    try $limit extract s.nrrd --iso 0 -o m.glb
    try $limit extract s.nrrd --iso 0 -o m.glb --compress draco
done
make_vdb sphere s.vdb 2>/dev/null && for limit in 80000 100000 120000 130000 140000 160000 200000; do
    try $limit extract s.vdb --iso 0 -o m.stl
done
rm -f m.glb m.stl err s.glb s.vdb
ls -A
