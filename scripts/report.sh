#!/usr/bin/env bash
# Rewrites the tables of README.md and docs/, and the plots of docs/benchmarks.md, from the committed figures. The
# findings in docs/benchmarks.md are written by hand: that page names the commit of its figures.
#   scripts/report.sh [--check]         --check: changes nothing, fails if something would change
#                                       Both fail if docs/benchmarks.md names another commit than that of the figures.
#   scripts/report.sh --pictures        draws only the rendered pictures, with the crumple_benchmark that scripts/bench.sh builds
# Installs pinned packages from PyPI into build-report/.
set -euo pipefail
cd "$(dirname "$0")/.."
extra=plots arguments=("$@")
if [[ ${1-} == --pictures ]]; then
    extra=plots,pictures
    benchmark=build-bench/benchmarks/crumple_benchmark
    [[ -x $benchmark ]] || { echo "$0: $benchmark is missing; scripts/bench.sh builds it" >&2; exit 1; }
    arguments=(--pictures "$benchmark")
fi
python=build-report/venv/bin/python
[[ -x $python ]] || python3 -m venv build-report/venv
stamp=build-report/$extra.installed
if [[ ! -f $stamp || benchmarks/report/pyproject.toml -nt $stamp ]]; then
    "$python" -m pip install --quiet --disable-pip-version-check --editable "benchmarks/report[$extra]"
    touch "$stamp"
fi
"$python" -m crumple_report "${arguments[@]}"
