# Sourced by quickstart.sh and tests/run.sh: installs groups of cli/packages.txt with apt-get.
# Runs nothing when all of a group is there.

as_root() {
    if [ "$(id -u)" = 0 ]; then
        "$@"
    elif command -v sudo >/dev/null; then
        sudo "$@"
    else
        echo "cannot install packages: be root, or install sudo" >&2
        return 1
    fi
}

# Packages of the groups named that are not installed, on one line.
missing_packages() {
    for group in "$@"; do
        sed -n "s/^$group  *//p" "$(dirname "$0")/../cli/packages.txt"
    done | while read -r package about; do
        tool=$(echo "$about" | sed -n 's/.*(\([a-z0-9+-]*\))$/\1/p')
        if [ -n "$tool" ] && command -v "$tool" >/dev/null; then
            continue
        fi
        dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' ||
            printf '%s ' "$package"
    done
}

# install_packages WHAT GROUP...: false when some could not be had.
install_packages() {
    what=$1
    shift
    wanted=$(missing_packages "$@")
    [ -n "$wanted" ] || return 0
    echo "== installing $what: $wanted"
    as_root apt-get update -qq || return 1
    # shellcheck disable=SC2086
    DEBIAN_FRONTEND=noninteractive as_root apt-get install -y -qq --no-install-recommends $wanted \
        >/dev/null
}
