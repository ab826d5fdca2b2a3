#!/usr/bin/env bash
# Installs missing packages (Debian 12), builds, and runs the tests, those of the Python package first. Also tests real
# scenes if $CRUMPLE_DATA, or ../shared/data beside the checkout, contains them.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/install_dependencies.sh --tests --python --mpi  # Python is also for CMake: some tests are scripts
. scripts/ccache.sh
cmake --preset release -DCRUMPLE_WERROR=ON -DCRUMPLE_MPI=ON >/dev/null
cmake --build --preset release -j "$(nproc)"
scripts/test_python.sh
ctest --preset release -j "$(nproc)" "$@"
