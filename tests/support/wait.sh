# Waits for conditions, never for times; sourced by tests. The limit is for what hangs: no machine is
# so slow. CUBEWRIGHT_TEST_SLOW=10 makes it ten times as long.
limit_s=$((300 * ${CUBEWRIGHT_TEST_SLOW:-1}))

# wait_until COMMAND...: runs it again and again until it succeeds; 1 after limit_s.
wait_until() {
    wait_until_end=$(($(date +%s) + limit_s))
    until "$@"; do
        [ "$(date +%s)" -lt $wait_until_end ] || { echo "waited $limit_s s for: $*" >&2; return 1; }
        sleep 0.05
    done
}

# is_over PID: the process has ended. One that nobody has waited for yet has ended, too.
is_over() {
    ! kill -0 "$1" 2>/dev/null || grep -q '^State:[[:space:]]*Z' "/proc/$1/status" 2>/dev/null
}

# is_there_or_over FILE PID: the file is there, or the process that would make it is not.
is_there_or_over() {
    [ -e "$1" ] || is_over "$2"
}
