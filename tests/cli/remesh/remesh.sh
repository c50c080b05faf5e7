# Even triangles: what is printed and reported, what stays, and the same bytes for any number of threads.
cubewright make sphere -o s.nrrd --dims 24 -q
cubewright extract s.nrrd --iso 0 -o s.ply -q
cubewright remesh s.ply --edge 3mm -o even.ply
cubewright check even.ply --reference s.ply --tolerance 0.3mm --profile print -q && echo "sound and near"
cubewright remesh s.ply --edge 4mm --error 0.5% --fem -o '{stem}-fem.stl' -q && ls s-fem.stl
for t in 1 3; do cubewright remesh s.ply -e 3mm --adaptive --error 0.05mm -o t$t.ply -t $t --name t -q; done
cmp t1.ply t3.ply && echo "same"
cubewright remesh s.ply -e 3mm -o even.ply --fem --json - -q |
    sed -n -e '/"params"/,/"iterations"/p' -e '/"below"/p' -e '/"beyond"/p' -e '/"intersections/p'

# a cube keeps its twelve edges; parts stay parts
cat >cube.obj <<'E2'
o cube
v 0 0 0
v 4 0 0
v 0 4 0
v 4 4 0
v 0 0 4
v 4 0 4
v 0 4 4
v 4 4 4
f 1 3 4 2
f 5 6 8 7
f 1 2 6 5
f 3 7 8 4
f 1 5 7 3
f 2 4 8 6
o sheet
v 9 0 0
v 12 0 0
v 12 3 0
f 9 10 11
E2
cubewright remesh cube.obj --edge 1mm -o fine.obj
grep '^o' fine.obj

# an angle that no triangle can do without
printf 'v 0 0 0\nv 9 0 0\nv 9 1 0\nf 1 2 3\n' >wedge.obj
cubewright remesh wedge.obj --edge 1mm --fem -o w.obj
echo "exit $?"

# rough surfaces: a place where nothing may move without harm stays as it is
cubewright make sphere --noise 6 --dims 24 -o noisy.nrrd -q
cubewright extract noisy.nrrd --iso 0 -o noisy.ply -q
for options in "--edge 7mm" "--edge 7mm --adaptive" "--edge 14mm --adaptive"; do
    # shellcheck disable=SC2086
    cubewright remesh noisy.ply $options -o made.ply -q || echo "$options: exit $?"
    cubewright check made.ply -q || echo "$options: made.ply is not sound"
done
