#!/usr/bin/env bash
# Builds fuzz targets and runs them, all at once, on seeds and on inputs that earlier runs have found (docs/fuzzing.md).
#   scripts/fuzz.sh readers|search|features|worlds|overlaps... [options of libFuzzer, such as -max_total_time=60 or -runs=1000000]
# Builds in build-address, as for the tests under AddressSanitizer. The output of the targets is in build-fuzz: NAME.log,
# corpus/NAME, artefacts/NAME. Prints inputs that fail, also as base64.
set -euo pipefail
cd "$(dirname "$0")/.."
names=()
while [[ ${1-} == readers || ${1-} == search || ${1-} == features || ${1-} == worlds || ${1-} == overlaps ]]; do names+=("$1"); shift; done
if ((${#names[@]} == 0)); then
    echo "usage: $0 readers|search|features|worlds|overlaps... [options of libFuzzer]" >&2
    exit 2
fi

scripts/install_dependencies.sh --tests --fuzz
. scripts/ccache.sh
cmake --preset address -DCRUMPLE_FUZZ=ON >/dev/null
mkdir -p build-fuzz
cmake --build --preset address -j "$(nproc)" --target "${names[@]/#/fuzz_}" >build-fuzz/build.log || {
    grep -v '^\[' build-fuzz/build.log
    exit 1
}
rm -rf build-fuzz/seeds
python3 tests/fuzz/make_seeds.py build-fuzz/seeds

# Limits AddressSanitizer's quarantine to 16 MiB and its stacks to four frames; the defaults would take a third of the time.
# The options -handle_...=0 below let AddressSanitizer, not libFuzzer, report memory errors, because a target adds the current
# input to AddressSanitizer's report.
export ASAN_OPTIONS=quarantine_size_mb=16:malloc_context_size=4

# Runs the target $1 with the remaining arguments as options.
run() {
    local name=$1 log=build-fuzz/$1.log artefacts=build-fuzz/artefacts/$1 options started artefact
    shift
    case $name in
        readers) options=(-max_len=4096 -dict=tests/fuzz/readers.dict -entropic=0) ;;
        # -detect_leaks=0 turns off the check after each input, which would report detectors that live across inputs as leaks;
        # leaks at the end are still reported. -entropic... mutates inputs that run fast, that is small scenes, more often than
        # slow ones, which gives three times as many inputs in the same time.
        *) options=(-max_len=512 -detect_leaks=0 -entropic=1 -entropic_scale_per_exec_time=1) ;;
    esac
    mkdir -p "build-fuzz/corpus/$name" "$artefacts"
    started=build-fuzz/$name.started
    touch "$started"
    if "build-address/tests/fuzz/fuzz_$name" "${options[@]}" -timeout=20 -rss_limit_mb=2048 -malloc_limit_mb=256 \
        -handle_segv=0 -handle_bus=0 -handle_fpe=0 -print_final_stats=1 -artifact_prefix="$artefacts/" "$@" \
        "build-fuzz/corpus/$name" "build-fuzz/seeds/$name" >"$log" 2>&1; then
        echo "$name: $(grep -E '^#[0-9]+\s+DONE' "$log")"
        return
    fi
    grep -vE '^#[0-9]+\s|NEW_FUNC' "$log" | tail -n 200
    for artefact in $(find "$artefacts" -type f -newer "$started"); do
        printf '\n%s, for base64 -d:\n' "$artefact"
        base64 "$artefact"
    done
    return 1
}
processes=()
for name in "${names[@]}"; do run "$name" "$@" & processes+=($!); done
status=0
for process in "${processes[@]}"; do wait "$process" || status=1; done
exit "$status"
