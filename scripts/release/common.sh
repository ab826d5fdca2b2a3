# Paths and output functions of the release scripts, which source this file.
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
here=$top/scripts/release
dist=$top/dist
work=$top/build-release
numbers='s/^#define CRUMPLE_VERSION_(MAJOR|MINOR|PATCH) ([0-9]+)$/\2/p'
suffix=$(sed -nE 's/^#define CRUMPLE_VERSION_SUFFIX "(.*)"$/\1/p' "$top/include/crumple/version.h")
version=$(sed -nE "$numbers" "$top/include/crumple/version.h" | paste -sd.)$suffix
deb_version=${version%"$suffix"}${suffix/./\~}
interface=$(sed -nE "$numbers" "$top/include/crumple/version.h" | head -n 2 | paste -sd.)  # MAJOR.MINOR
numpy=$work/numpy  # folder of NumPy's wheels, for installations without a package index

step() { printf "\n== %s (%s)\n" "$1" "$(date +%T)"; }
fail() { echo "release: $1" >&2; exit 1; }
# quietly LOG COMMAND...: runs a command and shows its output only if it fails.
quietly() {
    local log=$1
    shift
    "$@" >"$log" 2>&1 || { tail -n 100 "$log" >&2; fail "$* failed; its output is in $log"; }
}
version_of() { "$1" -c 'import sys; print("%d.%d" % sys.version_info[:2])'; }
# environment FOLDER PYTHON PACKAGES...: makes a virtual environment with these packages.
environment() {
    local folder=$1 python=$2
    shift 2
    [[ -x $folder/bin/python ]] || "$python" -m venv "$folder"
    (($# == 0)) || "$folder/bin/python" -m pip --quiet --disable-pip-version-check install "$@"
}
