#!/usr/bin/env bash
# Builds the Python package as pip does, installs it into a virtual environment of its own (build-python/), and runs its
# tests and examples:
#   scripts/test_python.sh [--all | --sanitize | --cuda | --mpi | --quick] [pytest's options]
# --all also installs the packages that crumple works with (PyVista, Open3D, JAX, Warp, IPC Toolkit, ...: about 3 GB),
# whose tests are otherwise skipped; PyTorch is tested if it is installed. --sanitize builds with AddressSanitizer and
# runs the tests of arrays, their lifetimes and threads. --cuda and --mpi do not install the package but build its extension
# modules: one with the cuda backend on an emulated device (cuda_on_cpu/README.md) and, if MPI is installed, that of
# crumple.mpi. --cuda runs the tests of arrays on a device, --mpi those of ranks. --quick builds the extension module
# without installing the package, and leaves out tests that need the installed package. The environment variable PYTHON names
# the interpreter (default: python3).
set -euo pipefail
cd "$(dirname "$0")/.."
all=() sanitize='' cuda='' mpi=() quick=''
case ${1-} in
    --all) all=(--python-peers); shift ;;
    --sanitize) sanitize=-sanitized; shift ;;
    --cuda) cuda=1; shift ;;
    --mpi) mpi=(--mpi); shift ;;
    --quick) quick=1; shift ;;
esac
scripts/install_dependencies.sh --python "${all[@]}" "${mpi[@]}"
! command -v ccache >/dev/null || . scripts/ccache.sh

version=$("${PYTHON:-python3}" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
environment=build-python/venv-$version$sanitize
python=$environment/bin/python
[[ -x $python ]] || "${PYTHON:-python3}" -m venv "$environment"
pip() { "$python" -m pip --disable-pip-version-check --quiet "$@"; }
"$python" -c 'import hypothesis, meshio, nanobind, pytest, scikit_build_core, trimesh, xdist' 2>/dev/null ||
    pip install 'scikit-build-core>=0.11' 'nanobind>=3' numpy pytest pytest-xdist hypothesis trimesh meshio
# Without its dependencies, which are packages for pictures and files that the tests do not need.
"$python" -c 'import yourdfpy' 2>/dev/null || pip install --no-deps yourdfpy lxml six ||
    echo "Left out, because pip cannot install it: yourdfpy" >&2
if ((${#all[@]})); then
    for package in pyvista open3d jax warp-lang mypy pillow ipctk libigl meshlib trueform python-fcl scipy coal mujoco newton; do
        pip install "$package" || echo "Left out, because pip cannot install it: $package" >&2
    done
fi

# Builds the extension modules in the folder $1, with the remaining arguments as CMake options. Copies them and the package's
# Python sources into $1/package, and sets PYTHONPATH to that.
modules() {
    local folder=$1 package=$1/package/crumple
    shift
    cmake -G Ninja -S . -B "$folder" -DCMAKE_BUILD_TYPE=Release -DCRUMPLE_PYTHON=ON -DCRUMPLE_WERROR=ON \
        -DCRUMPLE_EXAMPLES=OFF -DPython_EXECUTABLE="$PWD/$python" "$@" >/dev/null
    cmake --build "$folder" --target crumple_python -j "$(nproc)"
    rm -rf "$package"
    mkdir -p "$package"
    cp -r python/crumple/. "$folder"/python/_*.so "$package"
    export PYTHONPATH=$PWD/$folder/package PYTHONDONTWRITEBYTECODE=1
}
# Builds the extension modules with parts that the package as pip builds it lacks: the cuda backend on an emulated device and,
# if MPI and mpi4py are installed, the module of crumple.mpi.
special_modules() {
    local with_mpi=OFF
    ! command -v mpirun >/dev/null || ! "$python" -c 'import mpi4py' 2>/dev/null || with_mpi=ON
    modules build-python-special -DCRUMPLE_MPI=$with_mpi
}
if [[ $cuda ]]; then
    special_modules
    CRUMPLE_CUDA_ON_CPU=1 exec "$python" -m pytest -q -n "$(nproc)" python/tests/test_{arguments,device,input}.py \
        "python/tests/test_mpi.py::test_case_passes_on_all_ranks[arrays_can_be_in_device_memory-3]" "$@"
fi
if [[ $quick ]]; then
    modules build-python-quick -DCRUMPLE_TESTS=OFF
    exec "$python" -m pytest -q -n "$(nproc)" -m "not installed" "$@"
fi
if ((${#mpi[@]})); then
    "$python" -c 'import mpi4py' 2>/dev/null || pip install 'mpi4py>=4'
    special_modules
    exec "$python" -m pytest -q -n "$(nproc)" python/tests/test_{mpi,examples}.py -k 'mpi or ranks' "$@"
fi

log=build-python/build-$version$sanitize.log
echo "Building the Python package (the first time takes some minutes)"
settings=(--config-settings=build-dir="build-python-$version$sanitize" --config-settings=cmake.args=-GNinja)
if [[ $sanitize ]]; then
    # The interpreter is not linked with AddressSanitizer, so the tests preload its library. The build imports the module, to
    # write its stub, without preloading; verify_asan_link_order=0 permits that. The search for leaks is off, since Python
    # itself does not free all memory at its exit.
    settings+=(--config-settings=cmake.define.CRUMPLE_SANITIZE=address)
    export ASAN_OPTIONS=detect_leaks=0:verify_asan_link_order=0
else
    settings+=(--config-settings=cmake.define.CRUMPLE_WERROR=ON)  # sanitized code causes additional warnings
fi
CMAKE_BUILD_PARALLEL_LEVEL=$(nproc) pip install --verbose --no-build-isolation --no-deps --force-reinstall \
    "${settings[@]}" . >"$log" 2>&1 || { cat "$log" >&2; exit 1; }
if [[ $sanitize ]]; then
    tests=(python/tests/test_{agreement,arguments,exit,feature*,input,methods,motion,near}.py)
    tests+=(python/tests/test_{pickling,property,results,threads,world*}.py)
    # Preloads libstdc++ as well, because the sanitizer must find it before the first exception is thrown.
    preload="$(g++ -print-file-name=libasan.so) $(g++ -print-file-name=libstdc++.so)"
    LD_PRELOAD=$preload ASAN_OPTIONS=detect_leaks=0 "$python" -m pytest -q -n "$(nproc)" "${tests[@]}" "$@"
else
    "$python" -m pytest -q -n "$(nproc)" "$@"
fi
