#!/usr/bin/env bash
# Builds the Python package as pip does, installs it into a virtual environment of its own (build-python/), and runs its
# tests and examples:
#   scripts/test_python.sh [--all] [pytest's options]
# --all also installs the packages that it works with (PyVista, Open3D, JAX, Warp, IPC Toolkit, ...: about 3 GB), whose
# tests are skipped otherwise; PyTorch is tested where it is installed. PYTHON names the interpreter.
set -euo pipefail
cd "$(dirname "$0")/.."
all=()
if [[ ${1-} == --all ]]; then
    all=(--python-peers)
    shift
fi
scripts/install_dependencies.sh --python "${all[@]}"

version=$("${PYTHON:-python3}" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
environment=build-python/venv-$version
python=$environment/bin/python
[[ -x $python ]] || "${PYTHON:-python3}" -m venv "$environment"
pip() { "$python" -m pip --disable-pip-version-check --quiet "$@"; }
"$python" -c 'import hypothesis, meshio, nanobind, pytest, scikit_build_core, trimesh' 2>/dev/null ||
    pip install 'scikit-build-core>=0.10' 'nanobind>=3' numpy pytest hypothesis trimesh meshio
if ((${#all[@]})); then
    for package in pyvista open3d jax warp-lang mypy pillow ipctk libigl meshlib trueform python-fcl; do
        pip install "$package" || echo "Left out, for pip cannot install it here: $package" >&2
    done
fi

log=build-python/build-$version.log
echo "Building the Python package (the first time takes some minutes)"
settings=(--config-settings=build-dir="build-python/cmake-$version" --config-settings=cmake.args=-GNinja)
CMAKE_BUILD_PARALLEL_LEVEL=$(nproc) pip install --verbose --no-build-isolation --no-deps --force-reinstall \
    "${settings[@]}" . >"$log" 2>&1 || { cat "$log" >&2; exit 1; }
"$python" -m pytest -q "$@"
