#!/usr/bin/env bash
# Makes the sdist, and checks its content:
#   scripts/release/sdist.sh PYTHON FOLDER     an interpreter that has scikit-build-core, and the output folder
set -euo pipefail
. "$(dirname "$0")/common.sh"
mkdir -p "$2"
out=$(cd "$2" && pwd)
cd "$top"
program='import sys; from scikit_build_core.build import build_sdist; build_sdist(sys.argv[1])'
said=$("$1" -W ignore -c "$program" "$out" 2>&1) || { echo "$said" >&2; exit 1; }
"$1" "$here/check_sdist.py" "$out/crumple-$version.tar.gz" "$version" "$top"
# Checks that CMake can configure the unpacked sdist, which fails if a source file is missing.
unpacked=$(mktemp -d)
trap 'rm -rf "$unpacked"' EXIT
tar xzf "$out/crumple-$version.tar.gz" -C "$unpacked" --strip-components=1
cmake -S "$unpacked" -B "$unpacked/build" -G Ninja -DCRUMPLE_TESTS=OFF -DCRUMPLE_EXAMPLES=OFF >/dev/null
