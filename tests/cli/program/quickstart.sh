# The quickstart's own lines, on a small head: a mesh, a picture and a report.
set -e
cubewright=cubewright scan=head.nii.gz iso=-300 mesh=head.glb
cubewright version --features | grep -q '^glb *yes' || mesh=head.stl
cubewright make ct-head --dims 64 --type i16 -o $scan -q
grep '^"$cubewright" [er]' "$TESTS/../cli/quickstart.sh" | sed 's/--budget 30s/--budget 1s/' >lines
grep -c . lines
. ./lines >said 2>&1 || cat said
cubewright check $mesh -q
[ "$(wc -c <head.png)" -gt 50000 ] && grep -c '</html>' head.html
