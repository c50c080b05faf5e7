#!/bin/sh
# Makes the Debian packages of cubewright in build/packages: sh cli/make_packages.sh
# The short tests run, too; not with DEB_BUILD_OPTIONS=nocheck.
# Then: apt-get install ./build/packages/*.deb
set -eu
cd "$(dirname "$0")/.."
set -- # the functions of packages.sh look at $0 alone
. cli/packages.sh
install_packages "what the packages are made of" needed optional heavy package
case " ${DEB_BUILD_OPTIONS:-} " in *" nocheck "*) ;; *) install_packages "what tests need" test ;; esac

version=$(sed -n 's/^#define CW_VERSION "\(.*\)"/\1/p' include/cubewright/core.h)
[ "$(dpkg-parsechangelog -l cli/debian/changelog -S Version)" = "$version" ] ||
    { echo "make_packages: cli/debian/changelog has another version than $version" >&2; exit 1; }
folder=build/packages
source=$folder/cubewright-$version
rm -rf "$folder"
mkdir -p "$source"
for entry in *; do
    [ "$entry" = build ] || cp -a "$entry" "$source/"
done
cp -a cli/debian "$source/debian"
echo "== building in $source, ten minutes on two cores with the tests"
(cd "$source" && DEB_BUILD_OPTIONS="${DEB_BUILD_OPTIONS:-} noautodbgsym parallel=$(nproc)" dpkg-buildpackage -b -us -uc) >"$folder/build.log" 2>&1 ||
    { grep -A 30 '[*][*][*]' "$folder/build.log" >&2; tail -n 40 "$folder/build.log" >&2; exit 1; } # failed tests
rm -rf "$source"
ls -l "$folder"/*.deb | awk '{print $5, $NF}'
