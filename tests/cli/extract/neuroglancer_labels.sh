# Labels and isosurfaces as segments of a folder of Neuroglancer's meshes.
cubewright version --features | grep -q '^neuroglancer *yes' || { echo "this build has no Draco" >&2; exit 77; }
cubewright make labels/cells -o cells.nrrd --dims 32 --labels 4 --type u8 -q
printf '1 left lung\n2 "right" lung\n3 heart\n4 liver\n' >names.txt
cubewright extract cells.nrrd --labels all --names names.txt -o mesh --format neuroglancer
ls mesh
sed -e 's/\(mm[23]".*values": \).*/\1.../' mesh/segment_properties/info
# levels of detail are in the same folder
cubewright extract cells.nrrd --labels all --lod 3k,1k,300 -o lod --format neuroglancer --json lod.json
ls
od -An -t u4 -j 24 -N 4 lod/3.index
grep -c '"status": "ok"' lod.json
cubewright extract cells.nrrd --labels all --lod 3k,1k,300 -o one --format neuroglancer -q -t 1
cubewright extract cells.nrrd --labels all --lod 3k,1k,300 -o many --format neuroglancer -q -t 4
for file in one/*; do
    [ -d "$file" ] || cmp "$file" "many/${file#*/}" || echo differs
done
cubewright extract cells.nrrd --labels 2,3 -o 'label-{label}' --format neuroglancer -q
ls label-2
cubewright extract cells.nrrd --iso 0.5 -o iso --format neuroglancer -q
ls iso
bad() { cubewright extract cells.nrrd --labels all --format neuroglancer "$@" || echo "exit $?"; }
bad -o bad --labels 0
bad -o bad --labels=-1
bad -o bad --labels 1.5
bad -o bad --shared-faces
bad -o 'bad-{lod}' --lod 1k
bad -o cells.nrrd
ls -d bad* 2>/dev/null
exit 0
