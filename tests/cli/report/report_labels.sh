# A label map as a report: a row for each label, whose numbers are those of extract, with names and
# colours; all labels can be turned.
cubewright make labels/cells -o cells.nrrd --dims 24 --labels 6 --type u8 -q
printf '#No. Label Name: R G B A\n1 Liver 200 30 40 0\n2 a<b> 10 250 40 0\n' >names.txt
cubewright report cells.nrrd --labels all --names names.txt -o cells.html --json cells.json || exit 1
sed -n 's/^  "schema": //p' cells.json
grep -c '^      "label": ' cells.json
grep -c '<tbody data-point="label-' cells.html
grep -c 'alt="The surface of label' cells.html
grep -o 'Liver</td>' cells.html
grep -q '<b>' cells.html && echo "markup got through"
grep -o 'All surfaces are closed manifolds' cells.html

# The triangles of a label are those of its mesh.
cubewright extract cells.nrrd --labels 3 -o three.stl --json three.json -q
of_three=$(sed -n 's/^ *"triangles": \([0-9]*\).*/\1/p' three.json | head -n 1)
sed -n '/^      "label": 3,/,/}/s/^ *"triangles": \([0-9]*\),/\1/p' cells.json | grep -qx "$of_three" &&
    echo "the triangles of extract"

# Each surface encloses what its voxels do, nearly.
awk '
/"voxels_mm3"/ {voxels = $2 + 0}
/"volume_mm3"/ {d = ($2 + 0) / voxels - 1; if (d > 0.05 || d < -0.05) print "off by " d; n++}
END {print n " volumes"}' cells.json

# Looks decide where nobody says; a level or settings of the other kind are refused.
cubewright report cells.nrrd -o looks.html -q && grep -c '<tbody data-point="label-' looks.html
cubewright report cells.nrrd --labels 2,5 -o two.html -q && grep -c '<tbody data-point="label-' two.html
try() {
    cubewright report "$@"
    echo "$?"
}
mkdir empty && cd empty || exit 1
try ../cells.nrrd --labels all -o x.html --iso 3
try ../cells.nrrd -o x.html --names ../names.txt
try ../cells.nrrd --labels 99 -o x.html
try ../cells.nrrd --labels none -o x.html
ls -A
