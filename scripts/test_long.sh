#!/usr/bin/env bash
# Runs tests that together take an hour or more, which .ci/run leaves out: the usual tests with more random cases, 64-bit
# Arm under qemu, the emulated device under ThreadSanitizer, the kernels' PTX for each generation of devices, clang-tidy's
# path analyzer, and the fuzz targets. Prints a table of figures for docs/fuzzing.md.
#   scripts/test_long.sh [READS [SEARCHES [WORLDS [OVERLAPS [FEATURES]]]]]
# The arguments are the numbers of inputs of the fuzz targets: by default 10 million for READS, 10,000 for FEATURES, which are
# slow, and 1 million for each other one.
set -euo pipefail
cd "$(dirname "$0")/.."
reads=${1:-10000000}
searches=${2:-1000000}
worlds=${3:-1000000}
overlaps=${4:-1000000}
features=${5:-10000}

row() {
    local log=build-fuzz/$1.log
    local stat done counters
    stat() { awk -v name="stat::$1:" '$1 == name { print $2 }' "$log"; }
    done=$(grep -E '^#[0-9]+\s+DONE' "$log")
    counters=$(sed -nE 's/.*Loaded 1 modules +\(([0-9]+) inline.*/\1/p' "$log")
    printf '| %s | %s | %s | %s of %s | %s | %s MiB |\n' "$1" "$(stat number_of_executed_units)" \
        "$(sed -nE 's/^Done [0-9]+ runs in ([0-9]+) second.*/\1/p' "$log")" \
        "$(sed -E 's/.*cov: ([0-9]+).*/\1/' <<<"$done")" "$counters" \
        "$(sed -E 's/.*corp: ([^ ]+).*/\1/' <<<"$done")" "$(stat peak_rss_mb)"
}

# Runs the usual tests with five times as many random cases, and tests that run only if CRUMPLE_ROUNDS is set.
CRUMPLE_ROUNDS=5 scripts/test.sh
ctest --preset release -C nvcc -L nvcc -j "$(nproc)"

# Compares the overlaps of a million pairs of small bodies with rational arithmetic; docs/overlap.md shows the output.
CRUMPLE_ROUNDS=4000 build/tests/overlaps/overlaps_test --gtest_brief=1 --gtest_filter='OverlapSmallCases.*'

# Tests the NEON kernels on an emulated 64-bit Arm processor.
scripts/test_arm64.sh

# Tests the emulated CUDA device itself, which .ci/run tests only if its files have changed.
cuda_on_cpu/test.sh

# Runs all tests with threads under ThreadSanitizer, those of the cuda backend on the emulated device, too.
scripts/install_dependencies.sh --tests --mpi --ci
cmake --preset thread -DCRUMPLE_EMULATED_DEVICE=ON
cmake --build --preset thread --target crumple_tests
ctest --preset thread -j "$(nproc)" --no-tests=error -L threads

# Compiles the whole cuda backend by nvcc. The tests above compile only its device code by nvcc.
if command -v nvcc >/dev/null; then
    cmake --preset cuda -DCMAKE_CUDA_ARCHITECTURES=90 >/dev/null
    cmake --build --preset cuda
fi

# Makes machine code of all kernels for the oldest and the newest supported devices. Interprets the PTX of the kernels that decide
# pairs for each generation of devices, since nvcc generates different PTX for each.
if [[ -x build/tests/ptx/ptx_kernels_test ]]; then
    cmake --build --preset release --target cuda_generations
    for architecture in 75 80 90 100 110 120; do
        files=()
        for source in intersections/intersection_narrow intersections/device_contacts features/feature_narrow overlaps/crossing_terms; do
            files+=("build/tests/ptx/${source//\//_}_$architecture.ptx")
            nvcc -std=c++20 --fmad=false --expt-relaxed-constexpr -I include -I src "-arch=compute_$architecture" -ptx \
                -o "${files[-1]}" "src/backends/cuda/$source.cu"
        done
        CRUMPLE_PTX=$(IFS=:; echo "${files[*]}") build/tests/ptx/ptx_kernels_test --gtest_brief=1
    done
fi

# The analyzer examines only functions that the given source file itself defines, not those of sources that a unity file
# includes, so unity builds are off. StackAddressEscape takes Boost's rational numbers for references that dangle.
cmake --preset tidy -DCRUMPLE_MPI=ON -DCRUMPLE_UNITY=OFF >/dev/null
run-clang-tidy -quiet -p build-tidy -checks='-*,clang-analyzer-*,-clang-analyzer-core.StackAddressEscape'

scripts/fuzz.sh readers -runs="$reads"
scripts/fuzz.sh search -runs="$searches"
scripts/fuzz.sh worlds -runs="$worlds"
scripts/fuzz.sh overlaps -runs="$overlaps"
scripts/fuzz.sh features -runs="$features"
printf '\n| target | executions | seconds | edges | corpus: inputs/bytes | memory |\n|---|---|---|---|---|---|\n'
row readers
row search
row worlds
row overlaps
row features
