#!/usr/bin/env bash
# Installs what is missing (Debian 12), builds, and runs the tests, those of the Python package first. Real scenes are
# tested too where $CRUMPLE_DATA, or ../shared/data beside the checkout, holds them.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/install_dependencies.sh --tests
# The Python package compiles the library once more, with the same flags: ccache remembers.
export CMAKE_CXX_COMPILER_LAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER-ccache}
export CCACHE_DIR=${CCACHE_DIR-$PWD/build/ccache} CCACHE_DEPEND=1
cmake --preset release -DCRUMPLE_WERROR=ON >/dev/null
cmake --build --preset release -j "$(nproc)"
scripts/test_python.sh
ctest --preset release -j "$(nproc)" "$@"
