# A volume of four steps, half a second apart: a sphere, nothing, a torus and a gyroid; with iso
# 0.5 each has its surface, but nothing: sh steps.sh SIZE >4d.nrrd
size=$1
mm=$(awk "BEGIN { printf \"%.9g\", 80 / ($size - 1) }")
folder=$(mktemp -d)
printf '%s\n' NRRD0005 'type: float' 'dimension: 4' 'space: left-posterior-superior' "sizes: $size $size $size 4" \
    "space directions: ($mm,0,0) (0,$mm,0) (0,0,$mm) none" 'space origin: (-40,-40,-40)' \
    'space units: "mm" "mm" "mm"' 'spacings: nan nan nan 0.5' 'units: "" "" "" "s"' \
    'endian: little' 'encoding: raw' ''
bytes=$((4 * size * size * size))
for field in sphere none torus gyroid; do
    if [ $field = none ]; then
        head -c $bytes /dev/zero
    else
        cubewright make $field -o "$folder/$field.nii" --dims "$size" -q && tail -c $bytes "$folder/$field.nii"
    fi
done
rm -r "$folder"
