# Solids that intersect become one, and sheets become thin solids: by CGAL.
cubewright version --features | grep -q '^wrap *yes' || { echo "this build has no CGAL" >&2; exit 77; }
cat >bars.off <<'E2'
OFF
16 24 0
-10 -1 -1
10 -1 -1
-10 1 -1
10 1 -1
-10 -1 1
10 -1 1
-10 1 1
10 1 1
-1.5 -10 -1.5
1.5 -10 -1.5
-1.5 10 -1.5
1.5 10 -1.5
-1.5 -10 1.5
1.5 -10 1.5
-1.5 10 1.5
1.5 10 1.5
3 0 4 6
3 0 6 2
3 1 3 7
3 1 7 5
3 0 1 5
3 0 5 4
3 2 6 7
3 2 7 3
3 0 2 3
3 0 3 1
3 4 5 7
3 4 7 6
3 8 12 14
3 8 14 10
3 9 11 15
3 9 15 13
3 8 9 13
3 8 13 12
3 10 14 15
3 10 15 11
3 8 10 11
3 8 11 9
3 12 13 15
3 12 15 14
E2
cubewright repair bars.off -o one.stl
cubewright check one.stl --profile print -q && echo "sound"
cubewright repair bars.off -o two.stl --keep-intersections --no-measure -q
echo "exit $?"
printf 'OFF\n4 2 0\n0 0 0\n8 0 0\n0 8 0\n8 8 0\n3 0 1 2\n3 1 3 2\n' >sheet.off
cubewright repair sheet.off -o plate.stl --wrap 1mm
cubewright check plate.stl --profile print -q && echo "a plate"
cubewright repair sheet.off -o plate.stl --wrap 0.001mm -q
echo "exit $?"
