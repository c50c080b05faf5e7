# Each input by itself: in order, side by side, skipped where done, and failures counted.
mkdir a b out
cubewright make sphere -o a/x.nrrd --dims 16 -q
cubewright make torus -o b/x.nrrd --dims 16 -q
echo damaged >b/y.nrrd
cubewright make labels/cells -o a/cells.nrrd --dims 16 --labels 4 --type u8 -q
cubewright extract '*/x.nrrd' --iso 0 -o 'out/{parent}-{stem}.stl' --jobs 2 --json-lines log.jsonl
ls out
sed 's/"seconds": [^,]*//; s/,,"report".*"status": "ok".*/ report/' log.jsonl
# done already, and one that fails: the others are not begun, unless the batch goes on
rm out/b-x.stl
cubewright extract b/y.nrrd a/x.nrrd b/x.nrrd --iso 0 -o 'out/{parent}-{stem}.stl' --batch || echo "exit $?"
cubewright extract b/y.nrrd a/x.nrrd b/x.nrrd --iso 0 -o 'out/{parent}-{stem}.stl' --keep-going --skip-existing \
    --json-lines log.jsonl || echo "exit $?"
sed 's/,"seconds": .*//' log.jsonl
# files of labels count as the output
cubewright extract a/cells.nrrd --labels all -o 'out/{stem}-{label}.ply' --batch -q
cubewright extract a/cells.nrrd --labels all -o 'out/{stem}-{label}.ply' --skip-existing
# other commands
cubewright info a/x.nrrd b/x.nrrd --batch | grep -e nrrd -e values
cubewright info '?/x.nrrd' --jobs 2 --json-lines - 2>/dev/null | sed 's/,"seconds.*schema/ schema/; s/,.*//'
cubewright report a/x.nrrd b/x.nrrd -o 'out/{parent}.html' --batch --budget 1s -q && ls out/*.html
# a pattern that folders alone match; a report that is named as if it were no page
cubewright extract '[ab]' --iso 0 -o 'out/{stem}.stl' -q || echo "exit $?"
cubewright extract '[a]' --iso 0 -o 'out/{stem}.stl' -q || echo "exit $?"
cubewright report a/x.nrrd -o out/x.pdf --budget 1s -q || echo "exit $?"
# the same bytes as one by one
cubewright extract a/x.nrrd --iso 0 -o one.stl -q && cmp one.stl out/a-x.stl && echo same
bad() { cubewright extract "$@" || echo "exit $?"; }
bad a/x.nrrd b/x.nrrd --iso 0 -o out/x.stl --batch
bad a/x.nrrd --iso 0 -o out/z.stl --batch --json r.json
bad 'c/*.nrrd' --iso 0 -o out/z.stl --batch
bad a/x.nrrd --iso 0 --skip-existing
bad a/x.nrrd --iso 0 -o out/z.stl --json-lines none/log.jsonl
cubewright report a/x.nrrd b/x.nrrd -o out/r.html --source a/x.nrrd || echo "exit $?"
cubewright extract a/x.nrrd --iso 0 -o out/z.stl --json-lines a/x.nrrd || echo "exit $?"
# a report that is lost is told beside inputs that failed, and alone
bad a/x.nrrd --iso 0 -o 'out/{stem}.stl' --json-lines /dev/full -q
bad b/y.nrrd --iso 0 -o 'out/{stem}.stl' --json-lines /dev/full -q
# tables are named for each input, and one that is missing is made although the mesh exists
cubewright make labels/cells --dims 12 --labels 2 --type u8 -o a/cells.nrrd -q
cp a/cells.nrrd b/more.nrrd
labels() { cubewright extract a/cells.nrrd b/more.nrrd --labels all -o 'out/{stem}.glb' -q --skip-existing "$@" || echo "exit $?"; }
labels --table 'out/{stem}.csv'
rm out/more.csv
labels --table 'out/{stem}.csv' && ls out/*.csv && cmp out/cells.csv out/more.csv && echo same
labels --table out/all.csv
