# A volume is resampled and denoised before its surface is made: in this order, with the facts said.
cubewright make sphere -o ball.nrrd --dims 24x24x12 --type i16 --noise 4 --seed 3 -q
cubewright extract ball.nrrd --iso 0 -o noisy.stl
cubewright extract ball.nrrd --iso 0 -o median.stl --denoise median:1
cubewright extract ball.nrrd --iso 0 -o gauss.stl --denoise gauss:0.8vox
cubewright extract ball.nrrd --iso 0 -o ab.stl --name ball --denoise gauss:2mm --resample 2x2x3mm:cubic
cubewright extract ball.nrrd --iso 0 -o ba.stl --name ball --resample 2x2x3mm:cubic --denoise gauss:2mm -q -t 1
cmp ab.stl ba.stl && echo same
cubewright extract ball.nrrd --iso 0 -o iso.stl --resample iso --json r.json -q
grep -A2 -e '"notes"' -e '"iso": [0-9]' r.json

# The same in other commands, which then measure these values.
cubewright extract ball.nrrd --iso 0 -o median.ply --denoise median:1 -q
cubewright check median.ply --source ball.nrrd --iso 0 --denoise median:1 2>&1 | grep -e denoised -e topology
cubewright info ball.nrrd --denoise median:3 | grep values
cubewright render ball.nrrd --iso 0 --denoise median:1 -o ball.png --backend cpu --size 64x64 2>&1 | grep denoised

# Refused.
try() {
    cubewright extract ball.nrrd -o no.stl -q "$@"
    echo "$? $*"
}
try --iso 0 --denoise median:4
try --iso 0 --denoise median:0
try --iso 0 --denoise gauss
try --iso 0 --denoise gauss:0vox
try --iso 0 --denoise gauss:5%
try --iso 0 --denoise gauss:65vox
try --iso 0 --resample 0mm
try --iso 0 --resample iso:spline
try --iso 0 --resample 1e-9mm
try --labels all --denoise median:1
try --iso 0 --denoise aniso --stream always
try --iso 0 --resample iso --crop 0:9,0:9,0:9 --prove-crop
try --iso 0 --resample 0.1mm --memory 64M
ls no.stl 2>&1 | sed 's/.*: No/No/'
