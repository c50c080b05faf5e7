#!/bin/sh
# From a fresh Debian 12 or 13 to the mesh of a real head: installs what is missing, builds, extracts,
# draws, and reports what other settings cost. Run it as root or with sudo at hand; safe to run
# twice. Results: head.glb, head.png and head.html in the current folder.
set -eu
here=$(pwd)
cd "$(dirname "$0")/.."
root=$(pwd)
set -- # the functions of packages.sh look at $0 alone
. cli/packages.sh
. cli/build.sh

install_packages "what the build needs" needed ||
    { echo "quickstart: the packages above could not be installed" >&2; exit 1; }
install_packages "optional libraries" optional ||
    echo "== some could not be installed: their features are left out"
install_packages "a real scan" data || echo "== mricron-data could not be installed"

echo "== configuring (release): each optional library is tried"
configure_preset release build/configure.log -DCUBEWRIGHT_TESTS=OFF
echo "== building in $root/build/release, one to two minutes on two cores"
started=$(date +%s)
build_preset release build/build.log
echo "== built in $(($(date +%s) - started)) s"
cubewright=$root/build/release/bin/cubewright

cd "$here"
scan=/usr/share/mricron/templates/ch2.nii.gz iso=50
if [ ! -r "$scan" ]; then
    echo "== no real scan: a synthetic CT head takes its place"
    scan=ct-head.nrrd iso=-300
    "$cubewright" make ct-head --dims 256 --type i16 -o "$scan"
fi
mesh=head.glb
"$cubewright" version --features | grep -q '^glb *yes' || mesh=head.stl

echo "== cubewright extract $scan --iso $iso -o $mesh"
"$cubewright" extract "$scan" --iso "$iso" -o "$mesh"
echo "== cubewright render $scan --iso $iso -o head.png"
"$cubewright" render "$scan" --iso "$iso" --camera front --size 900x900 -o head.png -q
echo "== $mesh and head.png are written; now the report, 30 seconds"
echo "== cubewright report $scan --iso $iso --budget 30s -o head.html"
"$cubewright" report "$scan" --iso "$iso" --budget 30s -o head.html
cat <<END

Look at the results:
  head.png    a picture of the head
  head.html   in a browser: what other settings cost, and how close they come
  $mesh    opens in Blender (File > Import), in Windows 3D Viewer, in any glTF viewer on the
              web, or with 'f3d $mesh' (Debian package f3d)
Next:  $cubewright help
END
