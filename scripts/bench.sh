#!/usr/bin/env bash
# Measures crumple against its peers and alone, prints tables, and writes the figures to benchmarks/results/NAME.json.
#   scripts/bench.sh [--quick] [NAME]
# NAME is the host name by default. A full run takes 25 to 55 minutes on two cores, and prints its duration at the end.
# --quick takes under two minutes once everything is built: it checks that everything works, but its figures are rough.
# Installs missing packages (Debian 12; Python peers into build-bench/python) and builds first. Real scenes come from
# $CRUMPLE_DATA or ../shared/data beside the checkout; without them, procedural scenes are measured.
set -euo pipefail
top=$(cd "$(dirname "$0")/.." && pwd)
build=$top/build-bench

quick=()
name=$(hostname)
for argument in "$@"; do
    case $argument in
        --quick) quick=(--quick) ;;
        -*) echo "usage: $0 [--quick] [NAME]" >&2; exit 2 ;;
        *) name=$argument ;;
    esac
done

"$top/scripts/install_dependencies.sh"
peers=(libcgal-dev libembree-dev libfcl-dev libeigen3-dev python3-venv)
missing=()
for package in "${peers[@]}"; do
    dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null | grep -qx installed || missing+=("$package")
done
if ((${#missing[@]})); then
    sudo=(); ((EUID == 0)) || sudo=(sudo)
    "${sudo[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" ||
        echo "Not installed, so left out: ${missing[*]}" >&2
fi

mkdir -p "$build"
echo "Building (the first time takes some minutes)"
{
    cmake -G Ninja -S "$top" -B "$build" -DCMAKE_BUILD_TYPE=Release -DCRUMPLE_BENCHMARKS=ON -DCRUMPLE_TESTS=OFF \
        -DCRUMPLE_CLI=OFF -DCRUMPLE_EXAMPLES=OFF
    cmake --build "$build" --target crumple_benchmark -j "$(nproc)"
} >"$build/build.log" 2>&1 || { cat "$build/build.log" >&2; exit 1; }
grep -h 'Benchmarks:' "$build/build.log" || true

python=$build/python/bin/python
[[ -x $python ]] || python3 -m venv "$build/python" || true
packages=(numpy ipctk meshlib libigl trueform coal)
nvidia-smi >/dev/null 2>&1 && packages+=(warp-lang)  # the only peer that runs on a CUDA device
for package in "${packages[@]}"; do
    [[ -x $python ]] || break
    "$python" -m pip show --quiet "$package" >/dev/null 2>&1 ||
        "$python" -m pip install --quiet --disable-pip-version-check "$package" ||
        echo "Not installed, so left out: $package" >&2
done

SECONDS=0
parts=("$build/contests.json" "$build/python.json" "$build/studies.json")
rm -f "${parts[@]}"
benchmark=$build/benchmarks/crumple_benchmark
"$benchmark" "${quick[@]}" --json "${parts[0]}"
if "$python" -c 'import numpy' 2>/dev/null; then
    "$python" "$top/benchmarks/peers_python.py" --benchmark "$benchmark" "${quick[@]}" --json "${parts[1]}"
else
    echo "Without peers from PyPI: there is no Python environment with NumPy" >&2
fi
"$benchmark" "${quick[@]}" --study all --json "${parts[2]}"

mkdir -p "$top/benchmarks/results"
CRUMPLE_BENCHMARK_SECONDS=$SECONDS python3 "$top/benchmarks/merge_results.py" "$benchmark" \
    "$top/benchmarks/results/$name.json" "${parts[@]}"
