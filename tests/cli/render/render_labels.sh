# Labels of a label map: each in its colour, as the mesh has it that extract makes.
cat >map.nrrd <<'MAP'
NRRD0004
type: unsigned short
dimension: 3
sizes: 5 4 3
encoding: ascii
space: left-posterior-superior
space directions: (1,0,0) (0,1,0) (0,0,2)
space origin: (10,0,0)

1 1 2 2 0
1 1 2 2 0
1 1 2 2 0
0 0 0 0 0
1 1 2 2 0
1 1 2 2 0
1 1 2 2 0
0 0 0 0 300
1 1 2 2 0
1 1 2 2 0
0 0 0 0 0
0 0 0 0 300
MAP
cat >names.csv <<'NAMES'
LabelValue,Name,Color_R,Color_G,Color_B,Color_A
1,Left Lung,1,128,254,255
2,Right Lung,9,8,7,51
300,"Node, small",255,0,0,255
NAMES
draw() { cubewright render map.nrrd --size 80x60 --camera 30,20 "$@"; }
draw --labels 1,300 --names names.csv -o two.png --json two.json
sed -n '/"labels": \[/,/^  \]/p' two.json
draw --labels 1 --names names.csv -o one.png -q
cubewright extract map.nrrd --labels 1 --names names.csv -o one.ply -q
cubewright render one.ply -o ply.png --size 80x60 --camera 30,20 -q
cmp one.png ply.png && echo "same as the mesh"
draw --labels 1 --names names.csv -o rough.png -q --smooth-labels off
cmp -s one.png rough.png || echo "another without smoothing"
draw --labels 'left*,7' --names names.csv -o left.png -q && cmp one.png left.png && echo "same by name"
# a label of opacity 0 is not there; the neighbour has the whole interface
draw --labels 1,2 --label-opacity 'Right Lung:0' --names names.csv -o clear.png -q
draw --labels 1,2 --label-opacity 'all:0,1:1' --names names.csv -o again.png -q && cmp clear.png again.png && echo "same opacities"
# a legend is drawn
draw --labels 1,2 --names names.csv -o legend.png -q --legend --label-opacity all:1
draw --labels 1,2 --names names.csv -o bare.png -q --label-opacity all:1
cmp -s legend.png bare.png || echo "a legend"
# a map is recognised, unless something else is asked for
cp names.csv map.csv
{
    printf 'NRRD0004\ntype: uchar\ndimension: 3\nsizes: 9 12 12\nencoding: ascii\n\n'
    awk 'BEGIN { for (n = 0; n < 9 * 12 * 12; n++) { i = n % 9; k = int(n / 108); print (i > 1 && k > 2 ? (i > 5 ? 4 : 9) : 0) } }'
} >blocks.nrrd
cubewright render blocks.nrrd -o auto.png --size 80x60 --names names.csv
cubewright render blocks.nrrd -o all.png --size 80x60 --labels all -q && cmp auto.png all.png && echo "same as all"
printf '4 255 0 0 1 1 0 "Four"\n9 0 255 0 1 1 1 "Nine"\n' >snap.label
cubewright render blocks.nrrd -o nine.png --size 80x60 --names snap.label
cubewright render blocks.nrrd -o again.png --size 80x60 --names snap.label --labels 9,4 --label-opacity 4:0 -q && cmp nine.png again.png && echo "same as hidden"
for other in '--iso 1' '--tf grey' '--mode vbuffer' --histogram; do
    cubewright render blocks.nrrd -o other.png --size 80x60 $other -q --json - --backend cpu | grep '"labels"'
done
cubewright render one.ply -o ply.png --size 8x8 --labels all || echo "exit $?"
bad() { draw -o bad.png "$@" || echo "exit $?"; }
bad --labels 7
bad --labels lng
bad --labels all --iso 1
bad --labels all --mesh one.ply
bad --labels all --mode composite
bad --labels all --color '#fff'
bad --labels all --cap --clip 1,0,0,12
bad --labels all --tf grey
bad --labels all --label-opacity 1
bad --labels all --label-opacity 1:2
bad --labels all --label-opacity Lng:1
bad --labels all --label-opacity all:0
bad --labels all --smooth-labels 3mm
bad --labels all --names missing.csv
bad --iso 1 --names names.csv
bad --iso 1 --legend
bad --labels all --label-opacity 1:0.5 --backend cpu
ls bad.png 2>/dev/null || echo none
