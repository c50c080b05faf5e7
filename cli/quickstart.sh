#!/bin/sh
# From a fresh Debian 12 to the mesh of a real head: installs what is missing, builds, extracts,
# and tells what other settings cost. Run it as root or with sudo at hand; safe to run twice.
# Results: head.glb, head.png and head.html here.
set -eu
here=$(pwd)
cd "$(dirname "$0")/.."
root=$(pwd)
set -- # the packages' functions look at $0 alone
. cli/packages.sh

install_packages "what the build needs" needed ||
    { echo "quickstart: the packages above could not be installed" >&2; exit 1; }
install_packages "what brings glTF and LZ4" optional ||
    echo "== without libtinygltf-dev there will be no GLB, without libopenmesh-dev no simplification"
install_packages "a real scan" data || echo "== mricron-data cannot be had"

echo "== building (release) in $root/build/release"
mkdir -p build
{ cmake --preset release -DCUBEWRIGHT_TESTS=OFF && cmake --build --preset release; } \
    >build/quickstart.log 2>&1 || { cat build/quickstart.log >&2; exit 1; }
cubewright=$root/build/release/bin/cubewright

cd "$here"
scan=/usr/share/mricron/templates/ch2.nii.gz iso=50
if [ ! -r "$scan" ]; then
    echo "== no real scan: a made CT head stands in for it"
    scan=ct-head.nrrd iso=-300
    "$cubewright" make ct-head --dims 256 --type i16 -o "$scan"
fi
mesh=head.glb
"$cubewright" version --features | grep -q '^glb *yes' || mesh=head.stl

echo "== cubewright extract $scan --iso $iso -o $mesh"
"$cubewright" extract "$scan" --iso "$iso" -o "$mesh"
echo "== cubewright render $scan --iso $iso -o head.png"
"$cubewright" render "$scan" --iso "$iso" --camera front --size 900x900 -o head.png -q
echo "== cubewright report $scan --iso $iso --budget 90s -o head.html"
"$cubewright" report "$scan" --iso "$iso" --budget 90s -o head.html
cat <<EOF

Look at it: head.png is a picture; head.html, in a browser, tells what other settings cost and how
close they come; $mesh opens in Blender (File > Import), in Windows' 3D Viewer, in any glTF viewer
on the web, or with 'f3d $mesh' (Debian package f3d).
Go on:      $cubewright help
EOF
