#!/usr/bin/env bash
# Builds and installs the shared libraries, and builds a project that uses them.
set -euo pipefail
. "$(dirname "$0")/common.sh"
step "shared libraries"
if command -v ccache >/dev/null; then
    cd "$top"
    . scripts/ccache.sh
fi
folder=$top/build-shared
prefix=$(mktemp -d)
trap 'rm -rf "$prefix"' EXIT
cmake -G Ninja -S "$top" -B "$folder" -DCMAKE_BUILD_TYPE=Release -DBUILD_SHARED_LIBS=ON -DCRUMPLE_TESTS=OFF \
    -DCRUMPLE_EXAMPLES=OFF >/dev/null
quietly "$work/shared.log" cmake --build "$folder" -j "${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}"
cmake --install "$folder" --prefix "$prefix" >/dev/null
cmake -G Ninja -S "$top/tests/consumer" -B "$prefix/consumer" -DCMAKE_PREFIX_PATH="$prefix" >/dev/null
cmake --build "$prefix/consumer"
"$prefix/consumer/consumer"
for library in crumple crumple_io; do
    readelf -d "$prefix/consumer/consumer" | grep "NEEDED.*lib$library\.so\.$interface\]" ||
        fail "the project is not linked with lib$library.so.$interface"
done
"$prefix/bin/crumple" --version
