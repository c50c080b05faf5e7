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
# a stack that is too low is raised, or named; threads have one of their own
for threads in 1 4; do
    (ulimit -S -s 64; cubewright extract s.nrrd --iso 0 -o m.stl -t $threads -q) || echo "a low stack, -t $threads: exit $?"
    (ulimit -s 64; cubewright extract s.nrrd --iso 0 -o m.stl -t $threads -q 2>err)
    case $? in 0) ;; 8) grep -q "memory is short: the stack" err || cat err ;; *) echo "a stack of 64 kB, -t $threads"; cat err ;; esac
done
try 300000 extract s.nrrd --iso 0 -o m.stl -t 500
cubewright extract s.nrrd --iso 0 -o s.glb -q 2>/dev/null && for limit in 12000 14000 16000 18000 20000 24000 28000; do
    try $limit extract s.nrrd --iso 0 -o m.glb
    try $limit extract s.nrrd --iso 0 -o m.glb --compress draco
done
# Draco's table is refused before it is made
if cubewright version --features | grep -q '^draco *yes'; then
    cubewright convert s.glb -o m.drc --compress draco --bits 30 --memory 300M 2>&1 | sed 's/leaves.*MiB/leaves N MiB/' | tail -1
    cubewright convert s.glb -o m.drc --compress draco --bits 26 --memory 300M -q || echo "26 bits do not fit"
    cubewright convert s.glb -o m.drc --compress draco --tolerance 1e-12mm --memory 40M 2>/dev/null | grep -o 'positions unchanged'
else
    echo "cubewright: m.drc: 30 bits a coordinate take up to 4 GiB while Draco encodes, and --memory leaves N MiB; 26 bits fit"
    echo "positions unchanged"
fi
make_vdb sphere s.vdb 2>/dev/null && for limit in 80000 100000 120000 130000 140000 160000 200000; do
    try $limit extract s.vdb --iso 0 -o m.stl
done
rm -f m.glb m.drc m.stl err s.glb s.vdb
ls -A
