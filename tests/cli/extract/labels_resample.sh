# Labels are sampled at other distances before they are cleaned and extracted, by names and numbers of their own.
cat >map.nrrd <<'EOF'
NRRD0004
type: unsigned short
dimension: 3
sizes: 7 5 3
encoding: ascii
space: left-posterior-superior
space directions: (1,0,0) (0,1,0) (0,0,3)

1 1 1 2 2 0 0
1 1 1 2 2 0 0
1 1 1 2 2 0 9
1 1 1 2 2 0 0
1 1 1 2 2 0 0
1 1 1 2 2 0 0
1 0 1 2 2 0 0
1 1 1 2 1 0 0
1 1 2 2 2 0 3
1 1 1 2 2 0 3
1 1 1 2 2 0 0
1 1 1 2 2 0 0
1 1 1 2 2 0 0
1 1 1 2 2 0 0
1 1 1 2 2 0 0
EOF
table() {
    cut -d, -f1,8,9 "$1"
}
cubewright extract map.nrrd --labels all --resample iso -o a.ply --name x --table a.csv --json a.json
table a.csv
grep -e '"resample"' -e '"name": "resample"' a.json
cubewright extract map.nrrd --labels all --resample 1mm:majority -o b.ply --name x -q -t 1
cmp a.ply b.ply && echo same
cubewright extract map.nrrd --labels all --resample iso:nearest -o c.ply --table c.csv
table c.csv
# Coarser voxels lose labels; those are named, also where they were chosen.
cubewright extract map.nrrd --labels all --resample 2x2x3mm -o d.ply --table d.csv
table d.csv
cubewright extract map.nrrd --labels 2,9 --resample 2x2x3mm -o e.ply
cubewright extract map.nrrd --labels all --resample iso --min-volume 3mm3 -o f.ply --table f.csv
table f.csv
# Numbers below 0 stay in names.
sed -e 's/unsigned short/short/' -e 's/ 9$/ -9/' map.nrrd >signed.nrrd
cubewright extract signed.nrrd --labels all --resample 2x2x3mm -o g.ply
# What is typed is kept for the next run.
cubewright extract map.nrrd --labels all --resample iso -o h.ply --name x --save-config run.json -q
grep resample run.json
cubewright extract map.nrrd --config run.json -o i.ply --name x -q
cmp a.ply i.ply && echo same
# Refused.
try() {
    cubewright extract map.nrrd -o no.ply -q "$@"
    echo "$? $*"
}
try --labels all --resample iso:linear
try --labels all --resample 1mm:lanczos
try --iso 1 --resample iso:nearest
try --iso 1 --resample 2mm:majority
try --labels all --resample iso:median
try --labels all --resample 9mm
try --labels all --resample iso --stream always
try --labels all --resample 0.01mm --memory 64M
cubewright render map.nrrd --iso 1 --resample iso:nearest -o no.png
echo "$?"
ls no.ply no.png 2>&1 | sed 's/.*: No/No/'
