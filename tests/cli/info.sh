# A volume of known truth, as text and as JSON.
cubewright make sphere -o s.nii.gz --dims 32x40x24 --type u8 -q
cubewright info s.nii.gz --levels
cubewright info s.nii.gz --histogram 4 | sed -n 6,9p
cubewright info s.nii.gz --json --histogram 2 >a.json
grep -e '"schema"' -e '"range"' -e '"dims"' a.json
cubewright make sphere -o f.nrrd --dims 16 -q
cubewright info f.nrrd
