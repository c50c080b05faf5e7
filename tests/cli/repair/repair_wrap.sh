# Sheets become thin solids, by CGAL.
cubewright version --features | grep -q '^wrap *yes' || { echo "this build has no CGAL" >&2; exit 77; }
printf 'OFF\n4 2 0\n0 0 0\n8 0 0\n0 8 0\n8 8 0\n3 0 1 2\n3 1 3 2\n' >sheet.off
cubewright repair sheet.off -o plate.stl --wrap 1mm
cubewright check plate.stl --profile print -q && echo "a plate"
cubewright repair sheet.off -o none.stl --wrap 0.001mm -q
echo "exit $?"
# a sound mesh is wrapped, too
cubewright repair plate.stl -o again.stl --wrap 2mm --no-measure
