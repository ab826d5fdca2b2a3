#!/usr/bin/env bash
# Tests that take an hour and more, which .ci/run leaves out: all others thoroughly, the kernels' PTX for each generation of
# devices, paths through the code by clang-tidy's analyzer, then fuzz targets. Prints a table of figures, for docs/fuzzing.md.
#   scripts/test_long.sh [READS [SEARCHES [WORLDS [OVERLAPS]]]]   how many inputs of each fuzz target; ten, one, one and one million
set -euo pipefail
cd "$(dirname "$0")/.."
reads=${1:-10000000}
searches=${2:-1000000}
worlds=${3:-1000000}
overlaps=${4:-1000000}

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

# More of what is random, and what the usual run leaves out.
CRUMPLE_ROUNDS=5 scripts/test.sh
ctest --preset release -C nvcc -L nvcc -j "$(nproc)"

# A million small overlaps against rational arithmetic; docs/overlap.md has what this prints.
CRUMPLE_ROUNDS=1000 build/tests/overlaps/overlaps_test --gtest_brief=1 --gtest_filter='OverlapSmallCases.*'

# The player of devices, of which .ci/run tests only what has changed.
cuda_on_cpu/test.sh

# The usual tests compile only the device's part of the cuda backend by nvcc.
if command -v nvcc >/dev/null; then
    cmake --preset cuda -DCMAKE_CUDA_ARCHITECTURES=90 >/dev/null
    cmake --build --preset cuda
fi

# The optimizer of nvcc makes other code for other devices.
if [[ -x build/tests/ptx/ptx_kernels_test ]]; then
    for architecture in 75 80 90 100 110 120; do
        files=()
        for source in backends/cuda/intersections/intersection_narrow backends/cuda/intersections/device_contacts backends/cuda/features/feature_narrow; do
            files+=("build/tests/ptx/${source//\//_}_$architecture.ptx")
            nvcc -std=c++20 --fmad=false --expt-relaxed-constexpr -I include -I src "-arch=compute_$architecture" -ptx \
                -o "${files[-1]}" "src/$source.cu"
        done
        CRUMPLE_PTX=$(IFS=:; echo "${files[*]}") build/tests/ptx/ptx_kernels_test --gtest_brief=1
    done
fi

# The analyzer follows paths only through what is written in the file that it is given, so each file is one.
scripts/install_dependencies.sh --tests --mpi --ci
cmake --preset tidy -DCRUMPLE_MPI=ON -DCRUMPLE_UNITY=OFF >/dev/null
run-clang-tidy -quiet -p build-tidy -checks='-*,clang-analyzer-*'

scripts/fuzz.sh readers -runs="$reads"
scripts/fuzz.sh search -runs="$searches"
scripts/fuzz.sh worlds -runs="$worlds"
scripts/fuzz.sh overlaps -runs="$overlaps"
printf '\n| target | executions | seconds | edges | corpus: inputs/bytes | memory |\n|---|---|---|---|---|---|\n'
row readers
row search
row worlds
row overlaps
