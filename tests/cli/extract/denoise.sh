# Filters that keep edges take noise out before a surface is made, with values that are given or come
# from the noise of the data.
cubewright make sphere -o ball.nrrd --dims 32x32x20 --type i16 --noise 4 --seed 3 -q
for filter in gauss:1vox bilateral:1vox bilateral:3mm:12 aniso aniso:3 aniso:12:1.5 nlm nlm:6; do
    cubewright extract ball.nrrd --iso 0 -o ball.stl --denoise $filter --json r.json 2>&1 | sed 1d
    grep '"denoise"' r.json
done
cubewright extract ball.nrrd --iso 0 -o one.stl --denoise aniso -t 1 -q
cubewright extract ball.nrrd --iso 0 -o two.stl --denoise aniso -t 3 -q
cmp one.stl two.stl && echo same
cubewright make sphere -o clean.nrrd --dims 16 --type u8 -q
cubewright extract clean.nrrd --iso 0 -o clean.stl --denoise nlm 2>&1 | grep denoised

# Refused.
try() {
    cubewright extract ball.nrrd --iso 0 -o no.stl -q --denoise "$@"
    echo "$? $*"
}
try nlm:
try nlm:0
try nlm:4:2
try aniso:0
try aniso:101
try aniso:5:-1
try bilateral
try bilateral:5vox
try bilateral:1vox:x
try bilateral:1%
try aniso:100 --memory 3M
ls no.stl 2>&1 | sed 's/.*: No/No/'
