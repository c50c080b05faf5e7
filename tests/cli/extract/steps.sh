# Steps of one volume: a sphere, nothing, a torus and a gyroid, half a second apart.
sh "$TESTS/support/steps.sh" 16 >4d.nrrd
cubewright extract 4d.nrrd --iso 0.5 --steps all -o 'all-{step:03d}.stl' --json r.json
echo $?
sed -n '/"surfaces"/,$p' r.json | grep -e '"step"' -e '"time"' -e '"input"' -e '"triangles"' -e '"status"' -e '"path"'
grep -c '"params"' r.json
# as one by one, with the octree and without
for step in 0 2 3; do
    cubewright extract 4d.nrrd --iso 0.5 --step $step -o one.stl -q --name x
    cubewright extract 4d.nrrd --iso 0.5 --steps $step -o 'same-{step}.stl' -q --name x
    cubewright extract 4d.nrrd --iso 0.5,1 --steps 0:3:$((step > 0 ? step : 4)) -o '{level}_{step:02d}.stl' -q --name x
    cmp one.stl same-$step.stl && cmp one.stl 0.5_0$step.stl && echo "same at $step"
done
cubewright extract 4d.nrrd --iso 0.5 --steps 1,3 -o '{stem}{step}.glb' --preview --crop 0:9,0:9,0:9 -q
echo $?
cubewright extract 4d.nrrd --iso 0.5 --steps 1 -o none.stl -q
echo $?
ls *.glb *.stl && rm ./*.glb ./*.stl r.json

# A list of the files for ParaView.
mkdir vtp
cubewright extract 4d.nrrd --iso 0.5,9 --steps 0:2 -o 'vtp/{step}_{level}.vtp' --pvd run.pvd --json r.json | tail -n 1
grep DataSet run.pvd
sed -n '/"name": "pvd"/,/}/p' r.json
cubewright extract 4d.nrrd --iso 99 --steps 0:1 -o 'vtp/{step}.vtp' --pvd none.pvd -q
ls *.pvd

# Files of a series, in the order of their numbers; a pattern, or arguments.
for n in 1 2 10; do
    cubewright make sphere -o f$n.nrrd --dims $((10 + n)) -q
done
cubewright extract f10.nrrd f1.nrrd f2.nrrd --iso 0 -o 'a{step}.stl' --json r.json
sed -n '/"files"/,/\]/p' r.json
grep -e '"step"' -e '"input": "' r.json
cubewright extract 'f*.nrrd' --iso 0 -o '{stem}.stl' -q
for n in 0:1 1:2 2:10; do cubewright extract f${n#*:}.nrrd --iso 0 -o a.stl --name x -q; cmp -i 80 a.stl f${n#*:}.stl && cmp -i 80 a.stl a${n%:*}.stl && echo same; done
cubewright extract 'f*.nrrd' --iso 0 --steps 1:2 -o 's{step}.stl' -q
cubewright extract 'f1.nr*' --iso 0 -o one.stl -q
ls *.stl && rm ./*.stl

# What cannot be.
try() {
    cubewright extract "$@" -q
    echo "$? $*"
}
try 4d.nrrd --iso 0.5 --steps 0:4 -o 'x-{step}.stl'
try 4d.nrrd --iso 0.5 --steps 3,1 -o 'x-{step}.stl'
try 4d.nrrd --iso 0.5 --steps 0:3:0 -o 'x-{step}.stl'
try 4d.nrrd --iso 0.5 --steps 1: -o 'x-{step}.stl'
try 4d.nrrd --iso 0.5 --steps every -o 'x-{step}.stl'
try 4d.nrrd --iso 0.5 --steps all --step 2 -o 'x-{step}.stl'
try 4d.nrrd --iso 0.5 --steps all -o x.stl
try 4d.nrrd --iso 0.5 --steps all -o '{stem}.stl'
try 4d.nrrd --iso 0.5,1 --steps all -o 'x-{step}.stl'
try 4d.nrrd --iso 0.5 --steps all -o 'x-{step:4d}.stl'
try 4d.nrrd --iso 0.5 --steps all -o 'x-{step:0400d}.stl'
try 4d.nrrd --iso 0.5 --steps all -o 'x-{stem:04d}.stl'
try f1.nrrd f2.nrrd --iso 0 -o x.stl
try f1.nrrd f2.nrrd --iso 0 --step 1 -o 'x-{step}.stl'
try f1.nrrd f2.nrrd --iso 0 --steps 0,2 -o 'x-{step}.stl'
try f1.nrrd 4d.nrrd --iso 0 -o 'x-{step}.stl'
try f1.nrrd no.nrrd --iso 0 -o 'x-{step}.stl'
try f1.nrrd f2.nrrd --iso 0 -o 'x-{step}.stl' --json f2.nrrd
try f1.nrrd f2.nrrd --iso 0 -o 'x-{step}.stl' --raw dims=4x4x4,type=u8
cp f1.nrrd x-1.stl
try f1.nrrd x-1.stl --iso 0 -o 'x-{step}.stl'
sed '/^space/d' 4d.nrrd | sed '/^spacings/d;s/^dimension.*/dimension: 3/;s/^sizes.*/sizes: 16 16 16/;/^units/d' >bare.nrrd
try f1.nrrd bare.nrrd --iso 0 -o 'x-{step}.stl'
sed 's/^kinds.*//;s/^sizes.*/sizes: 4 16 16 16/;s/^space directions.*/space directions: none (5,0,0) (0,5,0) (0,0,5)/;/^spacings/d;/^units/d' 4d.nrrd |
    sed 's/^endian/kinds: vector domain domain domain\nendian/' >vector.nrrd
try f1.nrrd vector.nrrd --iso 0 -o 'x-{step}.stl'
try f1.nrrd 'no*.nrrd' --iso 0 -o 'x-{step}.stl'
try 4d.nrrd --iso 0.5 --steps all -o 'x-{step}.ply' --pvd x.pvd
try 4d.nrrd --iso 0.5 --steps all -o 'x-{step}.vtp' --pvd x-2.vtp
try 4d.nrrd --iso 0.5 --steps all -o 'x-{step}.vtp' --pvd 4d.nrrd
try 4d.nrrd --iso 0.5 --steps all -o 'x-{step}.vtp' --pvd no/x.pvd
try 4d.nrrd --iso 0.5 --steps all -o 'x-{step}.vtp' --pvd run.pvd --no-clobber
try 4d.nrrd --iso 0.5 --steps all -o 'x-{step}.vtp' --pvd x.json --json x.json
try 4d.nrrd --iso 0.5 --animate -o x.vtp --pvd x.pvd
try 4d.nrrd --iso 0.5 -o x.vtp --pvd x.pvd
ls x-* *.pvd

# What is in them: of one file, of several, and of those that are no series.
cubewright info 4d.nrrd --step 3 | grep -e steps -e values
cubewright info 'f*.nrrd'
cubewright info f2.nrrd bare.nrrd
echo $?
cubewright info f2.nrrd vector.nrrd --json | grep -e schema -e '"path"' -e range -e agree -e finding
cubewright info f2.nrrd f1.nrrd --levels
echo $?
