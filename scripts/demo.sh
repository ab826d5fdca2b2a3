#!/usr/bin/env bash
# Finds every collision in a crumpled cloth of 92,000 triangles, or in your own files, and colours them:
#   scripts/demo.sh                   the cloth
#   scripts/demo.sh mesh.ply ...      each of your meshes (PLY, OBJ, STL, OFF) against itself
# Installs missing packages (Debian 12) and builds first. Writes pictures to demo/.
set -euo pipefail
case ${1-} in
    -h | --help) sed -n '2,5s/^# \{0,1\}//p' "$0"; exit ;;
    -?*) echo "demo.sh: $1 is not an option; see demo.sh --help" >&2; exit 2 ;;
esac
for file in "$@"; do
    [[ -r $file && ! -d $file ]] || { echo "demo.sh: cannot read $file" >&2; exit 2; }
done
top=$(cd "$(dirname "$0")/.." && pwd)

"$top/scripts/install_dependencies.sh"
echo "Building (the first time takes some minutes)"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
build() {
    cd "$top"
    cmake --preset user &&
        cmake --build --preset user --target crumple_cli -j "$(nproc)"
}
(build) >"$log" 2>&1 || { cat "$log" >&2; exit 1; }
crumple=$top/build-user/cli/crumple
mkdir -p "$top/demo"

files=("$@")
if ((${#files[@]} == 0)); then
    files=("$top/demo/cloth.ply")
    "$crumple" make cloth -o "${files[0]}"
fi

declare -A painted=()
for file in "${files[@]}"; do
    name=$(basename "${file%.*}")
    picture=$top/demo/$name-collisions
    for ((n = 2; ${painted[$picture]:-0}; n++)); do picture=$top/demo/$name-$n-collisions; done  # if names are equal
    painted[$picture]=1
    printf '\n%s\n\n' "$file"
    "$crumple" detect "$file" --stats -o "$picture.glb" -o "$picture.ply" -o "$picture.txt"
    printf '\nColliding triangles in colour: %s.glb and .ply (any viewer); the pairs: %s.txt\n' "$picture" "$picture"
done
