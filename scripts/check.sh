#!/usr/bin/env bash
# Checks a change in a few minutes, before it is committed: formatting, build, and the tests of the folders it touches.
#   scripts/check.sh [COMMIT]   changes since that commit; by default since HEAD or, if there are none, since HEAD~1
# For all tests: scripts/test.sh. For all checks that a change must pass before it is merged: .ci/run.
set -euo pipefail
case ${1-} in
    -h | --help) sed -n '2,4s/^# \{0,1\}//p' "$0"; exit ;;
    -*) echo "check.sh: $1 is not an option; see check.sh --help" >&2; exit 2 ;;
esac
cd "$(dirname "$0")/.."
. scripts/steps.sh
jobs=$(nproc)

base=${1-HEAD}
changed() { git diff --name-only --diff-filter=d "$1" -- && git ls-files --others --exclude-standard; }
files=$(changed "$base")
[[ -n $files || -n ${1-} ]] || files=$(changed HEAD~1)
[[ -n $files ]] || { echo "Nothing has changed since $base"; exit 0; }

# Maps the beginning of a changed file's path to the folders of tests/ whose tests are run, to `python` (the package's tests)
# or to `player` (the tests in cuda_on_cpu/). The first line that matches applies; lines without folders run no tests. Files
# in tests/ that no line matches map to their own folder.
table='
src/base                        detector cpu
src/geometry                    geometry intersections impacts proximities
src/exact/intersection          intersections agreement
src/exact/impact                impacts features
src/exact/proximity             proximities features
src/exact/distance              distances
src/filters/intersection        intersections stages agreement
src/filters/candidates          candidates
src/filters                     features stages
src/backends/cuda               cuda stages
src/backends/cpu/features       features stages
src/backends/cpu/candidates     candidates
src/backends/cpu                cpu stages agreement
src/backends/reference          agreement worlds features candidates distances
src/distributed                 distributed
src/io                          io cli python
src/checks                      cli python
src                             detector worlds features python
include                         detector worlds features python
scenes                          scenes agreement
cli                             cli
examples/python                 python
python                          python
cuda_on_cpu                     player
README.md                       docs python
docs                            docs python
tests/played                    cuda
tests/consumer
tests/device
tests/fuzz
'
tests_of() {
    local beginning tests folder
    while read -r beginning tests; do
        [[ -z $beginning || $1 != "$beginning"* ]] || { echo "$tests"; return; }
    done <<<"$table"
    folder=$(dirname "$1")
    [[ $1 != tests/*/* ]] || echo "${folder##*/}"
}
suites=$(while read -r file; do tests_of "$file"; done <<<"$files")
read -ra suites <<<"$(tr ' ' '\n' <<<"$suites" | sort -u | tr '\n' ' ')"
echo "$(wc -l <<<"$files") changed files; tests of: ${suites[*]:-nothing}"

formatted() {
    local sources
    sources=$(grep -E '\.(h|cpp|cu|cuh)$' <<<"$files") || return 0
    xargs clang-format --dry-run --Werror <<<"$sources"
}
build() {
    cmake --preset release -DCRUMPLE_WERROR=ON -DCRUMPLE_MPI=ON >/dev/null
    cmake --build --preset release -j "$jobs" --target "$@"
}
wants() { [[ " ${suites[*]} " == *" $1 "* ]]; }

scripts/install_dependencies.sh --tests --python --mpi --ci
. scripts/ccache.sh
step "format" formatted
step "words" scripts/check_prose.py
targets=() labels=''
for suite in "${suites[@]}"; do
    [[ $suite != python && $suite != player ]] || continue
    targets+=("crumple_tests_of_$suite")
    labels+="${labels:+|}$suite"
done
if ((${#targets[@]})); then
    step "build" build "${targets[@]}"
    step "tests" ctest --preset release -j "$jobs" -L "^($labels)\$" -LE '^slow$'
fi
! wants player || step "the player of devices" cuda_on_cpu/test.sh
! wants python || step "Python" scripts/test_python.sh --quick
