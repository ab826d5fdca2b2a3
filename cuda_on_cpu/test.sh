#!/usr/bin/env bash
# Builds and runs the player's tests of itself: optimised, under AddressSanitizer and under ThreadSanitizer, which finds the
# planted races; with nvcc on the path, the portable tests and the planted kernels are compiled as CUDA, too.
#   cuda_on_cpu/test.sh [--if-changed]
# The file `tested` holds a digest of the files that passed last; with --if-changed nothing is done if they are those.
set -euo pipefail
cd "$(dirname "$0")"
digest=$(find . -type f ! -name '*.md' ! -name tested | LC_ALL=C sort | xargs sha256sum | sha256sum | cut -d ' ' -f 1)
if [[ ${1-} == --if-changed && $digest == "$(cat tested)" ]]; then
    echo "The player's files are those that passed its tests last"
    exit 0
fi
../scripts/install_dependencies.sh --tests --fuzz
for sanitizer in '' address,undefined thread; do
    build=../build-player/${sanitizer:-release}
    settings=(-DCMAKE_BUILD_TYPE=Release)
    [[ -z $sanitizer ]] || settings=(-DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_COMPILER=clang++
        "-DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-O1 -g1" "-DCUDA_ON_CPU_SANITIZE=$sanitizer")
    cmake -G Ninja -S . -B "$build" "${settings[@]}" >/dev/null
    cmake --build "$build"
    ctest --test-dir "$build" --output-on-failure -j "$(nproc)"
done
if [[ $digest != "$(cat tested 2>/dev/null)" ]]; then
    echo "$digest" >tested
    echo "Commit cuda_on_cpu/tested: until then .ci/run repeats these tests"
fi
