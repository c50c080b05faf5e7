# GIfTI and FreeSurfer's surfaces: written, read back, and placed in the frame of the scanner.
cat >t.obj <<'END'
# cubewright 0.2.0, RAS, mm
v 1 2 3
v 4 2 3
v 1 6 3
v 1 2 9
f 1 3 2
f 1 2 4
f 2 3 4
f 1 4 3
END
cubewright convert t.obj -o t.surf.gii
cubewright convert t.obj -o lh.white
cubewright convert t.obj -o lh.smoothwm --format freesurfer -q
cmp lh.white lh.smoothwm
for f in t.surf.gii lh.white; do
    cubewright convert "$f" -o back.off
    sed -n 2,8p back.off
done
# tkregister's coordinates of a volume whose centre is elsewhere
sed 's/^cras .*/cras   = 10 20 30/' lh.white >rh.pial
cubewright convert rh.pial -o back.off
sed -n 5p back.off
cubewright convert t.obj -o t.gii --unit m
echo "$? another unit"
sed 's/POINTSET/SHAPE/; s/TRIANGLE/LABEL/' t.surf.gii >t.shape.gii
cubewright check t.shape.gii
echo "$? no surface"
cubewright extract t.surf.gii --iso 1 -o t.ply
echo "$? no volume"
