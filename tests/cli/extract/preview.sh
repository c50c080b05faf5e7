# A preview is the surface of every 4th voxel, where it is, of what --crop leaves.
cubewright make sphere -o s.nrrd --dims 65 -q # 1.25 mm a voxel, centred on zero
cubewright extract s.nrrd --iso 0 -o p.stl --preview
cubewright make sphere -o coarse.nrrd --dims 17 -q
cubewright extract coarse.nrrd --iso 0 -o c.stl --name p -q
cmp p.stl c.stl && echo same
cubewright extract s.nrrd --iso 0,5 -o '{level}.stl' --name p --coarsen=4 --json r.json -q
cmp p.stl 0.stl && echo same
grep -e '"coarsen": \[' -e '"dims"' r.json
cubewright extract s.nrrd --iso 0 -o p.stl --preview --crop 1:63,30:33,0:64
cubewright extract s.nrrd --iso 0 -o p.stl --preview --coarsen 2 --crop 0:32,0:64,0:64 -v --no-check \
    2>&1 | grep -v -e ' s, '
cubewright extract s.nrrd --iso 0 -o p.stl --preview --coarsen 1000
for options in '--coarsen 1' '--coarsen 0' '--no-preview'; do
    cubewright extract s.nrrd --iso 0 -o p.stl $options --json - -q |
        sed '/^  "run"/,/^  }/d' | grep -c -e coarsen -e preview
done
for options in '--preview=4' '--coarsen -4' '--preview --crop 5:5,0:64,0:64' \
    '--preview --iso 99'; do
    cubewright extract s.nrrd --iso 0 -o no.stl $options -q
    echo "$? $options"
done
ls
