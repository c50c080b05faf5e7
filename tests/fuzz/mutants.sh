#!/bin/sh
# mutants.sh TARGET: runs a fuzz target on mutants of its corpus, the same ones each time; shows
# what it printed only if it fails.
set -eu
cd "$(dirname "$0")/../.."
new=$(mktemp -d)
trap 'rm -rf "$new"' EXIT
ASAN_OPTIONS=intercept_tls_get_addr=0 "$1" -seed=1 -runs=5000 -max_total_time=20 \
    -rss_limit_mb=4000 "$new" "tests/fuzz/corpus/${1##*/}" >"$new.log" 2>&1 || {
    cat "$new.log"
    exit 1
}
rm "$new.log"
