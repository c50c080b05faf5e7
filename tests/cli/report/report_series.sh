# A series as a report: a row for each step with the numbers of extract; a step without a surface says
# so; all pictures are from one place.
cubewright make sphere -o a_0.nrrd --dims 16 -q
cubewright make torus -o a_1.nrrd --dims 16 -q
cubewright make gyroid -o a_2.nrrd --dims 16 -q
cubewright report a_0.nrrd a_1.nrrd a_2.nrrd --iso 2 -o series.html --json series.json || exit 1
sed -n 's/^  "schema": //p; s/^  "level": //p' series.json
grep -c '^      "step": ' series.json
grep '"left_out"' series.json
grep -c '<tbody data-point="step-' series.html
grep -o 'alt="The surface of step [0-9]' series.html
grep -o '<h1>[^<]*' series.html
cubewright extract a_1.nrrd --iso 2 -o one.stl --json one.json -q
of_one=$(sed -n 's/^ *"triangles": \([0-9]*\).*/\1/p' one.json | head -n 1)
sed -n '/^      "step": 1,/,/}/s/^ *"triangles": \([0-9]*\),/\1/p' series.json | grep -qx "$of_one" &&
    echo "the triangles of extract"
if python3 -c 'import xml.dom.minidom' 2>/dev/null; then
    python3 -c 'import xml.dom.minidom, sys; xml.dom.minidom.parse(sys.argv[1])' series.html || echo "no XML"
fi
cubewright report 'a_*.nrrd' --steps 1,2 -o two.html --iso 1 -q && grep -c '<tbody data-point="step-' two.html

try() {
    cubewright report "$@"
    echo "$?"
}
mkdir empty && cd empty || exit 1
try ../a_0.nrrd ../a_1.nrrd -o x.html --budget 3s
try ../a_0.nrrd ../a_1.nrrd -o x.html --iso 9999 -q
try ../a_0.nrrd --steps 3 -o x.html
try ../a_0.nrrd ../none.nrrd -o x.html
try ../a_0.nrrd ../a_1.nrrd -o ../a_1.nrrd
try ../a_0.nrrd ../a_1.nrrd --source ../a_0.nrrd -o x.html
ls -A
