# Solids that intersect or share a wall become one.
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

# two cubes with one wall, whose corners they share
cat >wall.off <<'E2'
OFF
12 24 0
0 0 0
1 0 0
2 0 0
0 1 0
1 1 0
2 1 0
0 0 1
1 0 1
2 0 1
0 1 1
1 1 1
2 1 1
3 0 3 4
3 0 4 1
3 6 7 10
3 6 10 9
3 0 1 7
3 0 7 6
3 3 9 10
3 3 10 4
3 0 6 9
3 0 9 3
3 1 4 10
3 1 10 7
3 1 4 5
3 1 5 2
3 7 8 11
3 7 11 10
3 1 2 8
3 1 8 7
3 4 10 11
3 4 11 5
3 1 7 10
3 1 10 4
3 2 5 11
3 2 11 8
E2
cubewright repair wall.off -o box.stl
cubewright check box.stl --profile print -q && echo "sound"
cubewright check box.stl --json - -q | awk '/"volume"/ { printf "volume %.6g\n", $2 }'
