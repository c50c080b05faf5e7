# OpenVDB: what is in it, its surface, and what is not made for sparse grids.
cubewright formats --json | grep -A7 '"vdb"' | grep -q '"in_this_build": true' || exit 77
make_vdb sphere s.vdb several g.vdb bool b.vdb vec3 v.vdb
cubewright info s.vdb | sed -n 2,6p
cubewright info s.vdb --levels | grep zero
cubewright info g.vdb --grid density | sed -n -e 2p -e '/note/p' -e /values/p
cubewright info s.vdb --iso 0 >no.txt || echo "exit $?"
rm no.txt
cubewright info s.vdb --json | sed -n -e '/"sparse"/,/}/p'
cubewright extract s.vdb -o s.ply
cubewright extract s.vdb --iso 0.5 --inside above -o out.ply
cubewright extract s.vdb --iso -0.5,0,0.5 -o '{level}.stl' -q
cubewright extract s.vdb --simplify 0.1mm -o small.stl
cubewright extract b.vdb --iso 0.5 -o b.stl
cubewright extract s.vdb g.vdb --grid surface -o '{step}.ply' -q
cubewright render s.vdb -o s.png --size 64x64 | sed 's/;.*//'
ls | sort | tr '\n' ' '
cubewright info v.vdb || echo "exit $?"
cubewright info g.vdb --grid w || echo "exit $?"
cubewright extract b.vdb -o none.ply || echo "exit $?"
cubewright extract s.vdb --iso 5 -o none.ply -q || echo "exit $?"
cubewright extract s.vdb --snap 0.3 -o none.ply -q || echo "exit $?"
cubewright extract s.vdb --crop 0:9,0:9,0:9 -o none.ply -q || echo "exit $?"
cubewright extract s.vdb --preview -o none.ply -q || echo "exit $?"
cubewright extract s.vdb --max-triangles 100 -o none.ply -q || echo "exit $?"
cubewright extract s.vdb --memory 100k -o none.ply -q || echo "exit $?"
cubewright check s.ply --source s.vdb --iso 0 -q || echo "exit $?"
head -c 2000 s.vdb >cut.vdb
cubewright extract cut.vdb --iso 0 -o none.ply -q || echo "exit $?"
[ ! -e none.ply ]
