#!/bin/sh
# Does what the README says on machines that have nothing: bare Debian 12 and 13 roots in a temporary
# folder, with this machine's package sources and a clean copy of this tree.
# sh tests/fresh.sh [STAGE...]
#
# root     the quickstart as root; its mesh, picture, report and features are looked at
# trixie   after root: the same on Debian 13, and outputs of both have the same bytes
# without  after root: each optional package left out by itself; the rest still builds
# user     the quickstart as a user with sudo; what root has compiled is compiled no more
# needed   needed packages alone: no C++, no OpenGL; mesh and picture all the same
# tests    when it is asked for: the second command, `sh tests/run.sh`, on Debian 12 and 13
# packages the Debian packages: made twice with the same bytes, installed, used, removed without a trace
set -eu
cd "$(dirname "$0")/.."
tree=$(pwd)
stages=${*:-root trixie without user needed packages}

skip() { echo "fresh: skipped: $*"; exit 77; }
[ "$(id -u)" = 0 ] || skip "only root can make a Debian root"
command -v mmdebstrap >/dev/null || skip "mmdebstrap is not installed"
unshare --mount --pid --fork true 2>/dev/null || skip "this machine allows no mount namespaces"

folder=$(mktemp -d)
started=$(date +%s)
# Mounts live in namespaces of processes that end before this, so there are none to take down.
clean_up() {
    pkill -KILL -f "$folder/" || true # a worker that was interrupted
    rm -rf --one-file-system "$folder"
}
trap clean_up EXIT
trap 'exit 130' INT TERM HUP

fail() { echo "fresh: FAILED: $*"; exit 1; }
say() { echo "== fresh: $* ($(($(date +%s) - started)) s)"; }

# inside ROOT COMMAND: as root of that machine, with nothing of this one's environment. All that
# the command leaves running ends with it. Downloaded packages are shared between the roots.
inside() {
    unshare --mount --pid --fork --kill-child sh -euc '
        mount -t proc proc "$1/proc"
        mkdir -p "$1/dev/shm"
        mount -t tmpfs tmpfs "$1/dev/shm"
        mkdir -p "$1/dev/pts" # terminals, for shells that are typed in
        mount -t devpts -o newinstance,ptmxmode=0666 devpts "$1/dev/pts"
        touch "$1/dev/ptmx"
        mount --bind "$1/dev/pts/ptmx" "$1/dev/ptmx"
        mount --bind "$2" "$1/var/cache/apt/archives"
        exec chroot "$1" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root sh -euc "$3" </dev/null
    ' sh "$1" "$folder/archives" "$2"
}

# must WHAT ROOT COMMAND: shows what the command printed when it fails.
must() {
    inside "$2" "$3" >"$folder/said" 2>&1 || { cat "$folder/said"; fail "$1"; }
}

# The packages of groups of cli/packages.txt.
packages() {
    for group in "$@"; do
        sed -n "s/^$group  *\([^ ]*\).*/\1/p" cli/packages.txt
    done
}

# The tree as a commit would have it, in /src of a root.
copy_tree() {
    mkdir -p "$1/src"
    git ls-files -z --cached --others --exclude-standard |
        tar --create --null --files-from=- --ignore-failed-read 2>/dev/null | tar --extract --directory="$1/src"
}

# is_mesh ROOT FILE: closed and manifold, as our own reader finds it.
is_mesh() {
    must "$2 is no closed mesh" "$1" "$cubewright check $2"
}

# What a quickstart left in /results of a root.
look_at_results() {
    is_mesh "$1" /results/head.glb
    # a picture of one colour has 4 KB, the head's 200
    [ "$(wc -c <"$1/results/head.png")" -gt 50000 ] || fail "head.png is blank"
    grep -q '</html>' "$1/results/head.html" || fail "head.html is cut off"
    sed 's/<[^>]*>//g' "$1/results/head.html" | grep -q 'cubewright extract' ||
        fail "head.html lists no settings"
    [ ! -e "$1/results/ct-head.nrrd" ] || fail "the quickstart had no real scan: is mricron-data installed?"
    inside "$1" "$cubewright version --features" >"$folder/features"
    # CGAL and MPI are not in the quickstart
    if grep ' no: ' "$folder/features" | grep -v -e '^cgal ' -e '^wrap ' -e '^openmpi ' -e '^mpich '; then
        fail "the quickstart left the features above out: cli/packages.txt lacks what they need"
    fi
}
cubewright=/src/build/release/bin/cubewright

# lost_features OLD NEW: the lines of features that NEW no longer has, with the reasons.
lost_features() {
    sed -n 's/ *yes$//p' "$1" | while read -r name; do
        grep "^$name  *no: " "$2" || true
    done
}

# files_of ROOT PACKAGE: its files, without documentation, as paths within the root.
files_of() {
    inside "$1" "dpkg -L $2" | grep -v /usr/share/doc | while read -r path; do
        if [ -L "$1$path" ] || [ -f "$1$path" ]; then echo ".$path"; fi
    done
}

# leave_out ROOT PACKAGE: moves the package's files away, builds what is left, moves them back.
leave_out() {
    root=$1 package=$2
    files_of "$root" "$package" >"$folder/files.$package"
    if [ ! -s "$folder/files.$package" ]; then # it stands for those that it depends on
        inside "$root" "dpkg-query -W -f '\${Depends}\n' $package" | tr ',' '\n' | sed 's/^ *//; s/[ (].*//' |
            while read -r part; do files_of "$root" "$part"; done >"$folder/files.$package"
    fi
    tar --create --file="$folder/$package.tar" --directory="$root" --files-from="$folder/files.$package"
    (cd "$root" && xargs -d '\n' rm -f) <"$folder/files.$package"
    inside "$root" "
        cd /src && . cli/build.sh && configure_preset release build/configure.log -DCUBEWRIGHT_TESTS=OFF >build/left &&
        build_preset release build/build.log >build/built && $cubewright version --features >build/features &&
        cd /tmp && $cubewright make sphere -o s.nrrd --dims 24 -q && $cubewright extract s.nrrd --iso 0 -o s.stl -q &&
        $cubewright check s.stl -q && $cubewright render s.nrrd --iso 0 -o s.png --size 64x64 -q &&
        rm -rf i && cmake --install /src/build/release --prefix i >/dev/null && i/bin/cubewright check s.stl -q
        " >"$folder/said.$package" 2>&1 || { cat "$folder/said.$package"; fail "without $package it does not build"; }
    lost_features "$folder/features" "$root/src/build/features" >"$folder/lost.$package"
    tar --extract --file="$folder/$package.tar" --directory="$root"
    rm "$folder/$package.tar"
    grep -q "$package" "$folder/lost.$package" || {
        cat "$folder/lost.$package"
        fail "without $package no feature is missing that names it"
    }
    echo "   without $package: $(sed 's/  *no: .*//' "$folder/lost.$package" | tr '\n' ' ')"
}

# leave_out_all ROOT PACKAGE...
leave_out_all() {
    root=$1
    shift
    for left_out in "$@"; do
        leave_out "$root" "$left_out"
    done
}

# list_files ROOT: what stands in it, but for what all packages share.
list_files() {
    (cd "$1" && find . -xdev \( -path ./var -o -path ./tmp -o -path ./results -o -path ./etc/ld.so.cache \) -prune -o -print) | sort
}

# make_packages ROOT: builds them in /src and again in another folder, and compares.
make_packages() {
    must "the packages" "$1" "
        rm -rf /src/build
        cp -a /src /elsewhere
        cd /src && sh cli/make_packages.sh && mv build/packages /packages"
    say "the packages again"
    must "the packages again" "$1" "cd /elsewhere && rm -rf build && DEB_BUILD_OPTIONS=nocheck sh cli/make_packages.sh"
    for package in "$1"/packages/*.deb; do
        cmp "$package" "$1/elsewhere/build/packages/${package##*/}" || fail "${package##*/} differs when it is built again"
    done
    must "lintian" "$1" "
        apt-get install -y -qq --no-install-recommends lintian
        lintian --allow-root --fail-on error,warning /packages/*.changes"
}

# use_packages ROOT: what a user does with them.
use_packages() {
    must "the installed packages" "$1" "
        cd /results
        cubewright version --features >features
        ! grep ' no: ' features
        cubewright make ct-head -o head.nrrd --dims 64 -q
        cubewright extract head.nrrd --iso 300 -o head.glb
        cubewright check head.glb
        cubewright check head.glb --deep -q
        cubewright render head.nrrd --iso 300 -o head.png --size 600x600 -q"
    [ "$(wc -c <"$1/results/head.png")" -gt 10000 ] || fail "head.png is blank"
    must "the Python package" "$1" "
        cd /results
        python3 -c 'import cubewright; print(cubewright.__version__)'
        cd /src/tests/python && python3 -B -W error test_guide.py"
    must "manual pages and completion" "$1" "
        cd /results
        man cubewright-extract | grep -e '--iso'
        man 3 cubewright | grep cw_extract
        sh /src/tests/completion/completion.sh /usr/bin bash"
    must "a C program" "$1" "
        cd /results
        cc /src/tests/unit/test_api_is_c.c \$(pkg-config --cflags --libs cubewright) -o user && ./user"
}

# make_bare RELEASE ROOT: a bare system of a release, with the tree; false when it cannot be had.
make_bare() {
    mkdir -p "$folder/sources.$1"
    find /etc/apt -maxdepth 2 -path '*/sources.list*' \( -name '*.list' -o -name '*.sources' \) |
        while read -r source; do
            sed -e "s/bookworm/$1/g" -e "s/trixie/$1/g" "$source" >"$folder/sources.$1/${source##*/}"
        done
    mmdebstrap --quiet --variant=apt "$1" "$2" "$folder/sources.$1"/* >"$folder/said" 2>&1 || {
        cat "$folder/said"
        return 1
    }
    if [ -r /etc/ssl/certs/ca-certificates.crt ]; then
        mkdir -p "$2/etc/ssl/certs"
        cp /etc/ssl/certs/ca-certificates.crt "$2/etc/ssl/certs/"
    fi
    mkdir -p "$2/results"
    copy_tree "$2"
}

# list_outputs ROOT: hashes of meshes and volumes, and of a picture that no OpenGL draws. What is printed
# may name a library's version.
list_outputs() {
    must "the outputs" "$1" "cd /tmp && sh /src/tests/outputs.sh /src/build/release/bin >/results/outputs"
    grep -v -e '\.txt$' -e '\.out$' -e 'render-' -e 'compare\.png$' -e 'turn-' "$1/results/outputs"
}

# A root a stage, most from one bare system.
say "a bare Debian"
mkdir "$folder/archives"
make_bare bookworm "$folder/bare" || skip "mmdebstrap made no root from this machine's package sources"

for stage in $stages; do
    say "$stage"
    root=$folder/$stage
    case $stage in
    root)
        cp -a "$folder/bare" "$root"
        must "the quickstart as root" "$root" "cd /results && sh /src/cli/quickstart.sh"
        grep ' s$' "$folder/said" || true
        look_at_results "$root"
        must "the installed copy" "$root" "
            cmake --install /src/build/release --prefix /opt/cubewright
            cd /tmp && mv /src/build /src/hidden
            /opt/cubewright/bin/cubewright convert /results/head.glb -o head.glb --compress draco -q
            mv /src/hidden /src/build"
        ;;
    trixie)
        [ -d "$folder/root" ] || fail "trixie comes after root"
        if ! make_bare trixie "$root"; then
            say "skipped: this machine's package sources have no Debian 13"
            continue
        fi
        must "the quickstart on Debian 13" "$root" "cd /results && sh /src/cli/quickstart.sh"
        look_at_results "$root"
        say "the outputs of Debian 12 and 13"
        list_outputs "$folder/root" >"$folder/outputs.12"
        list_outputs "$root" >"$folder/outputs.13"
        [ "$(wc -l <"$folder/outputs.12")" -gt 60 ] || fail "there are but few outputs"
        diff "$folder/outputs.12" "$folder/outputs.13" || fail "the outputs above differ between Debian 12 and 13"
        rm -rf --one-file-system "$root"
        ;;
    without)
        [ -d "$folder/root" ] || fail "without comes after root"
        # Half of the packages in one root, half in a copy.
        cp -a "$folder/root" "$root"
        first='' second=''
        for package in $(packages optional | grep -x -e 'lib.*-dev' -e 'g++'); do # others are for run time
            [ ${#first} -lt ${#second} ] && first="$first $package" || second="$second $package"
        done
        # shellcheck disable=SC2086
        (leave_out_all "$root" $first) >"$folder/first" 2>&1 &
        worker=$!
        # shellcheck disable=SC2086
        (leave_out_all "$folder/root" $second) || fail "see above"
        wait $worker || { cat "$folder/first"; fail "see above"; }
        cat "$folder/first"
        ;;
    user)
        cp -a "$folder/bare" "$root"
        if [ -d "$folder/root/src/build" ]; then cp -a "$folder/root/src/build" "$root/src/build"; fi
        must "sudo" "$root" "
            apt-get update -qq && apt-get install -y -qq --no-install-recommends sudo
            useradd --create-home newcomer
            echo 'newcomer ALL=(ALL) NOPASSWD: ALL' >/etc/sudoers.d/newcomer
            chown -R newcomer: /src /results"
        must "the quickstart as a user" "$root" "
            cd /results
            exec setpriv --reuid newcomer --regid newcomer --init-groups env HOME=/home/newcomer sh /src/cli/quickstart.sh"
        look_at_results "$root"
        [ -z "$(find "$root/results" "$root/src" ! -user 1000 | head -1)" ] ||
            fail "files of another user: $(find "$root/results" "$root/src" ! -user 1000 | head -1)"
        ;;
    needed)
        cp -a "$folder/bare" "$root"
        must "needed packages alone" "$root" "
            apt-get update -qq
            apt-get install -y -qq --no-install-recommends $(packages needed | tr '\n' ' ')
            cd /src && . cli/build.sh
            configure_preset release build/configure.log -DCUBEWRIGHT_TESTS=OFF
            build_preset release build/build.log
            cd /results
            $cubewright make ct-head -o head.nrrd --dims 64 -q
            $cubewright extract head.nrrd --iso 300 -o head.stl
            $cubewright render head.nrrd --iso 300 -o head.png --size 600x600 -q"
        is_mesh "$root" /results/head.stl
        [ "$(wc -c <"$root/results/head.png")" -gt 10000 ] || fail "head.png is blank"
        ! inside "$root" "command -v c++" >/dev/null || fail "a C++ compiler is among the needed packages"
        inside "$root" "$cubewright version --features" >"$folder/features"
        for feature in simplify vdb gl window glb dicom tiff draco isal; do
            grep -q "^$feature  *no: not found: " "$folder/features" || fail "no reason why $feature is missing"
        done
        ;;
    tests)
        for release in bookworm trixie; do
            if ! make_bare $release "$root-$release"; then
                say "skipped: this machine's package sources have no $release"
                continue
            fi
            must "the tests on $release" "$root-$release" "cd /src && sh tests/run.sh"
            sed -n -e '/tests passed/p' -e '/did not run/,$p' "$folder/said"
            rm -rf --one-file-system "$root-$release"
            say "the tests of $release passed"
        done
        ;;
    packages)
        builder=$folder/builder
        if [ -d "$folder/root" ]; then cp -a "$folder/root" "$builder"; else cp -a "$folder/bare" "$builder"; fi
        make_packages "$builder"
        say "the packages installed"
        cp -a "$folder/bare" "$root"
        cp -a "$builder/packages" "$root/packages"
        rm -rf --one-file-system "$builder"
        must "apt-get install ./*.deb" "$root" "apt-get update -qq && apt-get install -y -qq /packages/*.deb"
        must "what users have" "$root" "apt-get install -y -qq --no-install-recommends man-db bash-completion gcc libc6-dev pkg-config"
        ours=$(cd "$root/packages" && ls *.deb | sed 's/_.*//' | tr '\n' ' ')
        # what they need stays: without and with them the same files stand beside them
        must "removing them" "$root" "apt-get purge -y -qq $ours"
        list_files "$root" >"$folder/before"
        must "apt-get install ./*.deb" "$root" "apt-get install -y -qq /packages/*.deb"
        use_packages "$root"
        must "removing them" "$root" "apt-get purge -y -qq $ours"
        list_files "$root" | diff "$folder/before" - || fail "the files above remain when the packages are removed"
        left=$(find "$root/var" -xdev -iname '*cubewright*' ! -path '*/apt/archives/*' ! -path '*/cache/man/*')
        [ -z "$left" ] || fail "files remain when the packages are removed: $left"
        ;;
    *) fail "there is no stage '$stage'" ;;
    esac
done
say "all stages passed"
