#!/usr/bin/env bash
# Installs what is missing (Debian 12), builds, and runs the tests, those of the Python package first. Real scenes are
# tested too where $CRUMPLE_DATA, or ../shared/data beside the checkout, holds them.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/install_dependencies.sh --tests --python --mpi  # CMake looks for Python, too: some tests are scripts
. scripts/ccache.sh
cmake --preset release -DCRUMPLE_WERROR=ON -DCRUMPLE_MPI=ON >/dev/null
cmake --build --preset release -j "$(nproc)"
scripts/test_python.sh
ctest --preset release -j "$(nproc)" "$@"
