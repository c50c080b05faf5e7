# Slices of label maps: colours of the nearest voxels; and labels over slices of another volume.
cubewright version --features | grep -q '^gl *yes' || { echo "this build has no OpenGL" >&2; exit 77; }
# make_map FILE REFINE: stripes of labels, each voxel cut into REFINE along x
make_map() {
    awk -v r="$2" -v at="$3" 'BEGIN {
        printf "NRRD0004\ntype: ushort\ndimension: 3\nsizes: %d 8 8\nencoding: ascii\n", 16 * r
        printf "space: left-posterior-superior\nspace directions: (%g,0,0) (0,1,0) (0,0,1)\n", 1 / r
        printf "space origin: (%g,0,0)\n\n", at - 0.5 + 0.5 / r
        for (n = 0; n < 1024 * r; n++) print substr("0295", 1 + int(n % (16 * r) / (4 * r)), 1) }' >"$1"
}
make_map map.nrrd 1 0
make_map fine.nrrd 2 0
make_map far.nrrd 1 40
sed '/^[0-9]$/s/.*/0/' map.nrrd >scan.nrrd
black='{"schema": "cubewright-transfer-1", "colors": [[0, "#000000"]], "opacities": [[0,1]]}'
draw() { cubewright render "$@" --size 96x72 --camera 30,30 --planes '0,0,1,3.2;1,0,0,6.3;1,2,1,14.1'; }
quad() { cubewright render "$@" --size 96x72 --layout quad; }
draw map.nrrd --labels all --mode slices -o base.png
draw map.nrrd --mode slices -o auto.png -q && cmp base.png auto.png && echo "recognised"
draw scan.nrrd --tf "$black" --overlay map.nrrd --overlay-opacity 1 -o over.png && cmp base.png over.png && echo "same over black"
draw scan.nrrd --tf "$black" --overlay fine.nrrd --overlay-opacity 1 -o fine.png -q && cmp base.png fine.png && echo "same on another grid"
draw scan.nrrd --mode slices -o plain.png -q
draw scan.nrrd --overlay map.nrrd --overlay-opacity 0 -o none.png -q && cmp plain.png none.png && echo "nothing at 0"
draw scan.nrrd --overlay map.nrrd -o some.png -q --labels 9 && ! cmp -s plain.png some.png && echo "something"
draw map.nrrd --mode slices --tf window -o grey.png -q && ! cmp -s base.png grey.png && echo "greys"
quad map.nrrd -o quad.png
quad map.nrrd --labels 2 -o two.png -q && ! cmp -s quad.png two.png && echo "another"
quad scan.nrrd --mode mip --overlay map.nrrd -o mip.png
bad() { draw "$@" -o bad.png -q || echo "exit $?"; }
bad scan.nrrd --overlay far.nrrd
bad scan.nrrd --overlay missing.nrrd
bad scan.nrrd --overlay scan.nrrd
bad scan.nrrd --overlay map.nrrd --overlay-opacity 2
bad scan.nrrd --overlay map.nrrd --mode mip
bad scan.nrrd --overlay map.nrrd --iso 1
bad scan.nrrd --overlay map.nrrd --labels 3
bad scan.nrrd --overlay-opacity 0.5
bad map.nrrd --mode slices --labels all --smooth-labels off
ls bad.png 2>/dev/null || echo none
