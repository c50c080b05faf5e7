# Label maps with a stated number of labels; what does not fit is refused.
cubewright make --list | grep '^labels/'
cubewright make labels/cells -o cells.nrrd --dims 24 --labels 8 --type u16
cubewright info cells.nrrd | grep -c ' voxels  label_'
cubewright extract cells.nrrd --labels all -o cells.ply | sed 's/;.*//'
cubewright make labels/spheres -o spheres.nii --dims 30x20x10 --labels 300 --type u8 || echo "exit $?"
cubewright make labels/spheres -o spheres.nii --noise 1 || echo "exit $?"
cubewright make sphere -o sphere.nrrd --labels 3 || echo "exit $?"
