#!/usr/bin/env bash
# Formats the C++ and CUDA sources; with --check it only reports files that are not formatted.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/install_dependencies.sh --ci
how=-i
[[ ${1-} != --check ]] || how='--dry-run --Werror'
git ls-files --cached --others --exclude-standard '*.h' '*.cpp' '*.cu' '*.cuh' | xargs clang-format $how
