# Fields of labels, in components, in time steps or in files, give the same surfaces.
fields() { # NAME KINDS SIZES, and which field is where: all (n), or one by its number
    printf 'NRRD0004\ntype: float\ndimension: %s\nsizes: %s\nkinds: %s\nencoding: ascii\n\n' "$4" "$3" "$2" >"$1"
    awk -v which="$5" 'BEGIN {
        for (z = 0; z < 14; z++) for (y = 0; y < 15; y++) for (x = 0; x < 20; x++) {
            e[0] = 1
            e[1] = exp(4.6 - sqrt((x - 6) ^ 2 + (y - 7) ^ 2 + (z - 6) ^ 2))
            e[2] = exp(5.3 - sqrt((x - 13) ^ 2 + (y - 7.3) ^ 2 + (z - 6.4) ^ 2))
            line = ""
            for (n = 0; n < 3; n++) if (which == "all" || which == n)
                line = line " " sprintf("%.6f", e[n] / (e[0] + e[1] + e[2]))
            print line
        }
    }' >>"$1"
}
fields all.nrrd 'list space space space' '3 20 15 14' 4 all
fields air.nrrd 'space space space' '20 15 14' 3 0
fields liver.nrrd 'space space space' '20 15 14' 3 1
fields spleen.nrrd 'space space space' '20 15 14' 3 2
cubewright extract all.nrrd --labels all --probabilities first -o a.ply --name x --table a.csv --json a.json
cubewright extract air.nrrd liver.nrrd spleen.nrrd --labels all --probabilities first -o b.ply --name x --table b.csv
tail -c 30000 a.ply >a.bin && tail -c 30000 b.ply | cmp - a.bin && echo same
cut -d, -f1,2,8,15 a.csv b.csv
grep -e '"probabilities"' -e '"fields"' -e '"max_move_voxels"' a.json | sort -u
# The background is the rest, or is below a value; labels are chosen by the names of their files.
cubewright extract liver.nrrd spleen.nrrd --labels all --probabilities rest -o c.ply --name x
cubewright extract liver.nrrd spleen.nrrd --labels 's*' --probabilities 0.5 -o '{name}.stl'
cubewright extract all.nrrd --labels all --probabilities first -o d.glb --shared-faces --simplify 0.1mm -q && cubewright check d.glb -q
cubewright extract all.nrrd --labels all --probabilities first -o e.ply --smooth-labels off
# Masks have no places between voxels.
sed 's/ *0\.[5-9][0-9]*/ 1/; s/ *0\.[0-4][0-9]*/ 0/' liver.nrrd >mask.nrrd
cubewright extract mask.nrrd --labels all --probabilities 0.5 -o m.ply
# A field that is nowhere the largest is named.
cubewright extract spleen.nrrd liver.nrrd spleen.nrrd --labels all --probabilities 0.5 -o n.ply --name x
# What cannot be is refused.
printf 'NRRD0004\ntype: float\ndimension: 3\nsizes: 2 2 2\nencoding: ascii\n\n1 1 1 1 1 1 1 1\n' >small.nrrd
for arguments in 'liver.nrrd small.nrrd --probabilities rest' 'liver.nrrd --probabilities first' \
    'liver.nrrd --probabilities half' 'liver.nrrd spleen.nrrd' 'all.nrrd --probabilities first --largest 1' \
    'all.nrrd --probabilities first --array x:1'; do
    cubewright extract $arguments --labels all -o no.ply -q
    echo "$?"
done
cubewright extract all.nrrd --probabilities first --iso 0.5 -o no.ply
