# The nearest name, the value expected, the usage.
for arguments in 'extrat' 'xyz' 'extract' 'extract a b --iso 1 -o c.glb' 'extract a --isso 1' \
    'extract a --iso' 'extract a --labels -o b.stl' 'extract a --iso one' 'extract a --iso=nan' 'extract a --inside left' \
    'extract a -z' 'extract a --open=yes' 'extract a --local=yes' 'extract a --spacing 1,2' 'extract a --spacing 0mm' \
    'extract a --memory 8X' 'extract a -o b.glb' 'extract a --iso 1' 'extract a --no-iso' \
    'make' 'make spere -o a.nrrd' 'make sphere' 'make sphere -o a.nrrd --dims 4x4' \
    'make sphere -o a.nrrd --type u64' 'make sphere -o a.stl' \
    'render a --iso 1 -o a.png --local' 'render a --iso 1 -o a.jpg' 'info' 'help extrct' 'help --search zebra' 'version now'; do
    cubewright $arguments
    echo "$? $arguments"
done
ls
