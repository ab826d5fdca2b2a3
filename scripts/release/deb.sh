#!/usr/bin/env bash
# Builds the Debian package of library, headers and command line: dist/crumple_VERSION_ARCHITECTURE.deb.
set -euo pipefail
. "$(dirname "$0")/common.sh"
step "Debian package"
unset CFLAGS CXXFLAGS CPPFLAGS LDFLAGS
if command -v ccache >/dev/null; then
    cd "$top"
    . scripts/ccache.sh
fi
folder=$top/build-deb
cmake -G Ninja -S "$top" -B "$folder" -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX=/usr -DCRUMPLE_TESTS=OFF \
    -DCRUMPLE_EXAMPLES=OFF >/dev/null
quietly "$work/deb.log" cmake --build "$folder" -j "${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}"
python3 "$here/licences.py" "$folder" "$folder/cli/crumple" >"$work/licences.txt"
mv "$work/licences.txt" "$folder/THIRD_PARTY_LICENSES.txt"
released=$(sed -nE 's/^## \[([0-9.]+)\].*/\1/p' "$top/CHANGELOG.md" | grep -vxF "$version" | head -n 1)
dpkg --compare-versions "$deb_version" gt "$released" || fail "$deb_version does not upgrade the package of $released"
(cd "$folder" && quietly "$work/cpack.log" cpack -G DEB -B "$work/deb")
mv "$work/deb/crumple_${deb_version}_$(dpkg --print-architecture).deb" "$dist"
dpkg-deb --field "$dist"/crumple_*.deb Package Version Architecture Installed-Size Depends
