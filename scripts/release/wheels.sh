#!/usr/bin/env bash
# Builds wheels from the sdist in dist/, and installs each in an environment without a compiler on the path:
#   scripts/release/wheels.sh PYTHON...         one wheel for each of 3.10 and 3.11, one of the stable ABI for all later ones
#   scripts/release/wheels.sh --cuda PYTHON...  the same with the cuda backend, as crumple-cudaN for version N of CUDA
# CRUMPLE_CUDA_ARCHITECTURES (CMake's CMAKE_CUDA_ARCHITECTURES) limits the supported devices, for faster trial builds.
set -euo pipefail
. "$(dirname "$0")/common.sh"
name=crumple backend=()
if [[ ${1-} == --cuda ]]; then
    shift
    nvcc=$(command -v nvcc) || fail "--cuda needs nvcc"
    name=crumple-cuda$("$nvcc" --version | sed -nE 's/.*release ([0-9]+)\..*/\1/p')
    backend=(--config-settings=cmake.define.CRUMPLE_CUDA=ON)
    [[ -z ${CRUMPLE_CUDA_ARCHITECTURES-} ]] ||
        backend+=(--config-settings=cmake.define.CMAKE_CUDA_ARCHITECTURES="$CRUMPLE_CUDA_ARCHITECTURES")
fi
# Ignores compiler flags of the environment, which could limit the wheels to machines like this one. SIMD kernels are chosen
# at run time.
unset CFLAGS CXXFLAGS CPPFLAGS CUDAFLAGS LDFLAGS
if command -v ccache >/dev/null; then
    cd "$top"
    . scripts/ccache.sh
fi

# Unpacks the sdist into $work/$name. Wheels are built there, so that they contain only files of the sdist.
unpack() {
    rm -rf "${work:?}/$name"
    mkdir -p "$work/$name" "$numpy"
    tar xzf "$dist/crumple-$version.tar.gz" -C "$work/$name" --strip-components=1
    [[ $name == crumple ]] || python3 "$here/rename.py" "$work/$name/pyproject.toml" "$name"
}

# build PYTHON VERSION: builds dist/NAME-VERSION-....whl.
build() {
    local environment=$work/build-$2 folder=$work/$name/build-python-$2
    environment "$environment" "$1" 'scikit-build-core>=0.11' 'nanobind>=3' 'numpy>=2'
    rm -rf "${work:?}/raw/$name-$2"
    cd "$work/$name"
    quietly "$work/$name-$2.log" "$environment/bin/python" -m pip --disable-pip-version-check --verbose wheel . \
        --no-build-isolation --no-deps --wheel-dir "$work/raw/$name-$2" \
        --config-settings=build-dir="$folder" --config-settings=cmake.args=-GNinja "${backend[@]}"
    "$work/tools/bin/python" "$here/finish_wheel.py" "$work/raw/$name-$2"/*.whl "$folder" "$dist"
}

# try PYTHON VERSION: tests the wheel in a new environment, without a compiler or anything else on the path.
try() {
    local environment=$work/try-$name-$2
    rm -rf "$environment"
    environment "$environment" "$1"
    pip() { "$environment/bin/python" -m pip --quiet --disable-pip-version-check "$@"; }
    pip download --dest "$numpy" --only-binary=:all: numpy
    pip install --no-index --find-links "$dist" --find-links "$numpy" "$name==$version"
    env -i PATH="$environment/bin" HOME="$work" "$environment/bin/python" -I "$here/quick_start.py" \
        "$top/docs/python.md"
    [[ $(uname -m) != x86_64 ]] || try_baseline "$environment"
}
# Checks that the command line writes the same bytes on an emulated x86-64 processor without SSE4 and AVX.
try_baseline() {
    local program folder
    if ! command -v qemu-x86_64-static >/dev/null; then
        echo "Not tested on an old processor, because qemu-x86_64-static is missing (apt install qemu-user-static)"
        return
    fi
    program=$(echo "$1"/lib/python*/site-packages/crumple/crumple)
    folder=$(mktemp -d)
    "$program" make cloth --triangles 2000 -o "$folder/cloth.ply"
    "$program" detect "$folder/cloth.ply" -o "$folder/here.csv"
    qemu-x86_64-static -cpu qemu64 "$program" detect "$folder/cloth.ply" -o "$folder/there.csv" --backend cpu
    cmp "$folder/here.csv" "$folder/there.csv"
    rm -r "$folder"
    echo "A processor without SSE4 finds the same pairs"
}

unpack
stable=''
for python in "$@"; do
    of=$(version_of "$python")
    case $of in
        3.10 | 3.11) ;;
        *)
            if [[ $stable ]]; then
                step "$name on Python $of, the wheel of $stable"
                try "$python" "$of"
                continue
            fi
            stable=$of
            ;;
    esac
    step "$name for Python $of"
    build "$python" "$of"
    try "$python" "$of"
done
