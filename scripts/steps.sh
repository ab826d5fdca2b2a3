# Sourced by scripts that run a sequence of steps:
#   step NAME COMMAND...    runs the command with its output in a log, and prints how long it took
# If the command fails, the script prints the end of the log, then the log's first failure, and exits.
log=$(mktemp)
trap 'rm -f "$log"' EXIT

# Matches the first line of a failure report of compilers, GoogleTest, ctest, pytest, sanitizers and scripts.
failure='(^|[^[:alnum:]_])([Ee]rror|ERROR):|(^|[^[:alnum:]])FAILED|: Failure|Traceback|Sanitizer:|\*\*\*(Failed|Timeout|Exception)|^E  '

step() {
    local name=$1 began=$SECONDS status
    shift
    printf '== %s (after %d s)\n' "$name" "$began"
    set +e
    (set -e; "$@") >"$log" 2>&1  # not in a condition or before ||, where bash ignores set -e
    status=$?
    set -e
    if ((status == 0)); then
        tail -n 1 "$log" | cut -c 1-200
        printf '   passed in %d s\n' $((SECONDS - began))
        return
    fi
    tail -n 300 "$log"
    printf '\n== FAILED: %s (status %d, after %d s). The first failure:\n' "$name" "$status" $((SECONDS - began))
    grep -nE -m 1 -A 25 "$failure" "$log" || tail -n 25 "$log"
    exit "$status"
}
