# A volume of known truth, as text and as JSON.
cubewright make sphere -o s.nii.gz --dims 32x40x24 --type u8 -q
cubewright info s.nii.gz --levels
cubewright info s.nii.gz --histogram 4 | sed -n 6,9p
cubewright info s.nii.gz --json --histogram 2 >a.json
grep -e '"schema"' -e '"range"' -e '"dims"' a.json
cubewright make sphere -o f.nrrd --dims 16 -q
cubewright info f.nrrd
# Of a file larger than the memory allowed some rows are read, and by --preview, too.
truncate -s 400M z.raw
printf '\377' | dd of=z.raw bs=1 seek=200M conv=notrunc 2>/dev/null # row 0 of slice 200
layout=dims=1024x1024x400,type=u8,spacing=1x1x1mm
cubewright info z.raw --raw $layout --memory 64M | grep values
cubewright info z.raw --raw $layout --memory 64M --json | grep -A1 -e sampled
cubewright info z.raw --raw $layout --deep --memory 64M -q 2>&1
cubewright extract z.raw --raw $layout --preview --memory 64M --iso 9 -o z.stl -q 2>&1; echo $?
