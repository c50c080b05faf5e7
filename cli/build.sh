# Sourced by quickstart.sh and tests/run.sh: configures and builds presets.

# configure_preset PRESET LOG [OPTION...]: says which features cannot be built, and why.
# Looks at the machine again each time: packages may have come or gone since the last build.
configure_preset() {
    preset=$1 log=$2
    shift 2
    mkdir -p "$(dirname "$log")"
    cmake --fresh --preset "$preset" "$@" >"$log" 2>&1 || { cat "$log" >&2; return 1; }
    sed -n '/: switched off by /d; s/^-- \(without .*\)/   \1/p' "$log"
}

# show_tenths PATTERN WORD: of lines that start with PATTERN and count as N/ALL, one at every tenth.
show_tenths() {
    awk -v pattern="$1" -v word="$2" '
        $0 ~ pattern && match($0, /[0-9]+\/[0-9]+/) {
            split(substr($0, RSTART, RLENGTH), count, "/")
            if (count[1] * 10 >= (shown + 1) * count[2]) {
                printf "   %s %d of %d\n", word, count[1], count[2]
                fflush()
                shown = int(count[1] * 10 / count[2])
            }
        }'
}

# build_preset PRESET LOG [OPTION...]: shows progress, and what went wrong when it fails.
build_preset() {
    preset=$1 log=$2
    shift 2
    rm -f "$log.failed"
    { cmake --build --preset "$preset" "$@" 2>&1 || touch "$log.failed"; } | tee "$log" |
        show_tenths '^\\[[0-9]+/[0-9]+\\]' step
    [ ! -e "$log.failed" ] || { grep -v '^\[[0-9/]*\] \(Building\|Linking\)' "$log" >&2; return 1; }
}
