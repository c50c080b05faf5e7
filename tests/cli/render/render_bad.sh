# What cannot be drawn, and what would do nothing.
cubewright make sphere -o v.nrrd --dims 8 -q
cubewright extract v.nrrd --iso 0 -o m.ply -q
echo '{"schema": "cubewright-transfer-1", "opacities": [[0, 2]]}' >bad.json
echo '{"schema": "cubewright-camera-1", "eye": [0, 0, 0]}' >eye.json
cat >g.vtu <<'END'
<VTKFile type="UnstructuredGrid"><UnstructuredGrid>
<Piece NumberOfPoints="4" NumberOfCells="1"><PointData Scalars="f">
<DataArray type="Float32" Name="f">9 9 9 0</DataArray></PointData>
<Points><DataArray type="Float64" NumberOfComponents="3">0 0 0  1 0 0  0 1 0  0 0 1</DataArray></Points>
<Cells><DataArray type="Int64" Name="connectivity">0 1 2 3</DataArray>
<DataArray type="Int64" Name="offsets">4</DataArray>
<DataArray type="UInt8" Name="types">10</DataArray></Cells></Piece>
</UnstructuredGrid></VTKFile>
END
try() {
    cubewright render "$@" -q
    echo "$? $*"
}
try v.nrrd
try v.nrrd -o a.jpg
try v.nrrd -o v.png --size 64
try v.nrrd -o v.png --samples 5
try v.nrrd -o v.png --mode raytrace
try v.nrrd -o v.png --mode mesh
try v.nrrd -o v.png --backend metal
try v.nrrd -o v.png --backend cpu --iso 0 --wireframe
try v.nrrd -o v.png --camera up
try v.nrrd -o v.png --camera 30,100
try v.nrrd -o v.png --camera 30,20,10
try v.nrrd -o v.png --camera eye.json
try v.nrrd -o v.png --camera none.json
try v.nrrd -o v.png --camera eye.json --ortho
try v.nrrd -o v.png --camera eye.json --fov 3
try v.nrrd -o v.png --ortho --fov 3
try v.nrrd -o v.png --fov 180
try v.nrrd -o v.png --zoom 0
try v.nrrd -o v.png --turntable 3
try v.nrrd -o v.png --orbit 90
try v.nrrd v.nrrd -o v.png
try v.nrrd -o '{turns}.png' --turntable 2
try v.nrrd -o v.png --tf bones
try v.nrrd -o v.png --tf bad.json
try v.nrrd -o v.png --tf none.json
try v.nrrd -o v.png --opacity=-1
try v.nrrd -o v.png --background red
try v.nrrd -o v.png --background '#fff,#12'
try v.nrrd -o v.png --light 1,2
try v.nrrd -o v.png --light 0,0,0
try v.nrrd -o v.png --light 0,0,1,-1,0,0
try v.nrrd -o v.png --light '1,0,0;1,0,0;1,0,0;1,0,0;1,0,0'
try v.nrrd -o v.png --ambient 2
try v.nrrd -o v.png --ambient 0 --diffuse 0 --specular 0
try v.nrrd -o v.png --depth-cue 1.5
try v.nrrd -o v.png --depth-cue-range 0,1
try v.nrrd -o v.png --depth-cue-form exponential
try v.nrrd -o v.png --depth-cue 0.5 --depth-cue-range 1,0.5
try v.nrrd -o v.png --depth-cue 1 --depth-cue-form exponential
try v.nrrd -o v.png --depth-cue 0.5 --mode mip
try v.nrrd -o v.png --clip 0,0,1
try v.nrrd -o v.png --clip 0,0,0,1
try v.nrrd -o v.png --clip 0,0,one,1
try v.nrrd -o v.png --clip-box 1:2,3:4
try v.nrrd -o v.png --clip-box 0:7,0:7,0:7 --clip '1,0,0,0;1,0,0,0;1,0,0,0;1,0,0,0;1,0,0,0;1,0,0,0;1,0,0,0'
try v.nrrd -o v.png --cut-away
try v.nrrd -o v.png --step-length 0
try v.nrrd -o v.png --stop-opacity 0
try v.nrrd -o v.png --stop-opacity 2
try v.nrrd -o v.png --mode texture --slices 5 --step-length 2
try v.nrrd -o v.png --mode splat-tree --tree-error 2
try v.nrrd -o v.png --mode splat --splat-width 9
try v.nrrd -o v.png --mode splat --splat-kernel cone
try v.nrrd -o v.png --mode slices --planes 1,0,0
try v.nrrd -o v.png --iso 0 --color mauve
try v.nrrd -o v.png --iso 0 --tint quality --tint-range 0,1
try v.nrrd -o v.png --iso 0 --tint scalars --tint-range 1,0
try v.nrrd -o v.png --iso 0 --mesh m.ply
try v.nrrd -o v.png --hide volume
try v.nrrd -o v.png --iso 0 --hide mesh
try m.ply -o v.png --mode composite
try m.ply -o v.png --mesh m.ply
try m.ply -o v.png --hide mesh
try m.ply -o v.png --clip-box 0:1,0:1,0:1
try m.ply -o v.png --tf auto
try none.nrrd -o v.png
try g.vtu -o v.png --mode splat
try v.nrrd -o v.png --json v.png
try v.nrrd -o v.png --save-tf v.nrrd
# An option for another mode says for which.
for option in '--threshold 3' --no-minip-inside '--slices 9' '--target 8' --colors-first '--normals 6' --boundary --material-table '--direction-filter nearest' \
    --linear-opacity --pixel-area '--tree-error 0.1' '--splat-kernel tent' '--splat-width 1' '--planes 1,0,0,0' --wireframe '--tint quality' --cap '--color white'; do
    try v.nrrd -o v.png $option
done
for option in --cell-steps --jitter --exact-filter '--texture-edge 9' '--step-length 2' \
    --no-skipping; do
    try v.nrrd -o v.png --mode projection $option
done
try v.nrrd -o v.png --mode mip --no-lit
try v.nrrd -o v.png --mode shaded-texture --colors-first --direction-filter nearest
try v.nrrd -o v.png --mode mip --lambert one-sided
ls
