#!/usr/bin/env bash
# Cross-compiles the library and the kernel tests for 64-bit Arm, and runs the tests of the NEON kernels under
# qemu-user. Debian packages of that architecture are not installed but unpacked into build-arm64/sysroot.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/install_dependencies.sh --tests --arm64
sysroot=$PWD/build-arm64/sysroot
if [ ! -e "$sysroot/done" ]; then
    mkdir -p "$sysroot" build-arm64/apt/lists/partial build-arm64/apt/cache/archives/partial
    apt=(-oAPT::Architecture=arm64 -oAPT::Architectures=arm64 -oDir::State::Lists="$PWD/build-arm64/apt/lists"
         -oDir::Cache="$PWD/build-arm64/apt/cache" -qq)
    apt-get "${apt[@]}" update
    (cd build-arm64/apt && apt-get "${apt[@]}" download libhwy1 libhwy-dev libgtest-dev librapidcheck-dev 2>/dev/null)
    for package in build-arm64/apt/*.deb; do dpkg -x "$package" "$sysroot"; done
    ln -sfn /usr/include/boost "$sysroot/usr/include/boost"
    touch "$sysroot/done"
fi
# Compiles everything but the kernels under test with -O1 only, since full optimisation of that code would take two thirds of
# the time. The kernels' sources have their own -O3.
cmake -S . -B build-arm64 -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_TOOLCHAIN_FILE=cmake/aarch64.cmake \
    -DCMAKE_CXX_FLAGS_RELEASE="-O1 -DNDEBUG" -DCRUMPLE_PARALLEL=std -DCRUMPLE_IO=OFF -DCRUMPLE_SCENES=OFF -DCRUMPLE_CLI=OFF -DCRUMPLE_EXAMPLES=OFF >/dev/null
cmake --build build-arm64 --target cpu_test stages_test
run() { qemu-aarch64-static -L /usr/aarch64-linux-gnu -E LD_LIBRARY_PATH="$sysroot/usr/lib/aarch64-linux-gnu" "$@"; }
run build-arm64/tests/cpu/cpu_test --gtest_filter='ClusterMembership.*:LeafRecords.*:Sweep.each_overlap*:PlaneSigns.*:Filter.*' &  # in parallel
run build-arm64/tests/stages/stages_test --gtest_filter='*/NEON'
wait $!
