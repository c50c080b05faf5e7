# Bits that are too few for the shape: an error names them, and no file appears; an old one stays.
cubewright version --features | grep -q '^draco *yes' || { echo "this build has no Draco" >&2; exit 77; }
cubewright make sphere -o s.nrrd --dims 32 -q
cubewright extract s.nrrd --iso 0 -o s.ply -q
for kind in draco meshopt quantize; do
    cubewright convert s.ply -o f.glb --compress $kind --bits 4 -q 2>said
    echo "$kind $? $(ls f.glb 2>/dev/null) $(grep -c 'so it was not written; without --bits enough bits are chosen' said)"
done
echo old >f.glb
cubewright convert s.ply -o f.glb --compress quantize --bits 4 -q 2>/dev/null
echo $? "$(cat f.glb)"
cubewright convert s.ply -o f.glb --compress quantize --bits 14 -q && cubewright check f.glb -q && echo "14 bits do"
