#!/usr/bin/env bash
# Gathers for scripts/gpu_check.sh what the machine with the device may lack: build-gpu/pack.tar.gz.
#   scripts/gpu_pack.sh [--warp]
# In it: the programs of the check, built here for $CUDAARCHS (default 90: machine code for compute capability 9.0, PTX
# for later ones), which find their libraries beside them; libraries, headers and tools to build them there, should these
# not start; real scenes of $CRUMPLE_DATA; nanobind, for the Python package. --warp lays NVIDIA Warp's wheel beside the
# pack: it is many times as large, and not everybody can carry it.
set -euo pipefail
top=$(cd "$(dirname "$0")/.." && pwd)
. "$top/scripts/gpu_common.sh"
export PATH=$PATH:/usr/local/cuda/bin
warp=''
case ${1-} in
    --warp) warp=1 ;;
    '') ;;
    *) echo "usage: $0 [--warp]" >&2; exit 2 ;;
esac
libraries=usr/lib/$(uname -m)-linux-gnu

build_programs() {
    local build=$top/build-gpu-programs  # not where the pack lies, which is carried as a folder
    cmake -G Ninja -S "$top" -B "$build" -DCMAKE_BUILD_TYPE=Release -DCRUMPLE_CUDA=ON \
        "-DCMAKE_CUDA_ARCHITECTURES=${CUDAARCHS:-90}" -DCRUMPLE_DEVICE_TESTS=ON -DCRUMPLE_BENCHMARKS=ON \
        -DCRUMPLE_TESTS=OFF -DCRUMPLE_EXAMPLES=OFF -DCMAKE_BUILD_WITH_INSTALL_RPATH=ON \
        "-DCMAKE_INSTALL_RPATH=\$ORIGIN/../$libraries" -DCMAKE_EXE_LINKER_FLAGS=-Wl,--disable-new-dtags >/dev/null
    ninja -C "$build" "${programs[@]}"
    mkdir -p "$tree/bin"
    local program
    for program in "${programs[@]}"; do strip -o "$tree/bin/${program##*/}" "$build/$program"; done
    sources_of "$top" >"$tree/sources"
    echo "${CUDAARCHS:-90}" | grep -o '[0-9]*' | sort -n | head -1 >"$tree/architecture"
}

# The files of the packages, and of Boost only what is included.
list_files() {
    local packages=(pkg-config pkgconf pkgconf-bin libpkgconf3 libtbb-dev libhwy-dev libcli11-dev libfmt-dev
        nlohmann-json3-dev libtinygltf-dev libstb-dev libminizip-dev zlib1g-dev libexpat1-dev libgtest-dev googletest) package
    for package in "${packages[@]}"; do
        dpkg -L "$package" 2>/dev/null || true
    done | grep -E '^/usr/(bin/pkg|include/|lib/|share/(cmake|pkgconfig))' | sort -u |
        while read -r file; do [[ -d $file && ! -L $file ]] || echo "$file"; done
    git -C "$top" grep -ho '#include <boost/[^>]*>' -- src | sort -u >"$lists/boost.cpp"
    echo '#include <boost/version.hpp>' >>"$lists/boost.cpp"
    g++ -std=c++20 -M "$lists/boost.cpp" | tr -s '\\ ' '\n' | grep '^/usr/include/boost/'
    find /usr/include/boost/config -type f
}

# Shared libraries that the listed ones and the programs need, but for the C and C++ libraries.
list_needed() {
    grep '\.so$' "$lists/files" | while read -r file; do echo "$file" "$file".*; done | tr ' ' '\n' >"$lists/shared"
    cat "$lists/shared"
    { cat "$lists/shared"; ls "$tree"/bin/*; } | xargs -r ldd 2>/dev/null | sed -n 's/.*=> \(\/[^ ]*\).*/\1/p' |
        grep -Ev '/(libc|libm|libdl|libpthread|librt|libgcc_s|libstdc\+\+)\.so' | sort -u |
        while read -r file; do echo "$file"; readlink -f "$file"; done
}

copy_scenes() {
    local data=${CRUMPLE_DATA:-$top/../shared/data} file
    for file in "${frames[@]}"; do
        if [[ -f $data/$file ]]; then
            install -D -m 644 "$data/$file" "$tree/data/$file"
        else
            echo "Without $file: it is not in $data" >&2
        fi
    done
}

# A wheel of PyPI's, into a folder.
download() {
    local name=$1 folder=$2
    shift 2
    python3 -m pip download --quiet --disable-pip-version-check --no-deps --only-binary=:all: "$@" --dest "$folder" "$name" ||
        echo "Without $name: pip could not download it" >&2
}

"$top/scripts/install_dependencies.sh" --tests
tree=$(mktemp -d) lists=$(mktemp -d)
trap 'rm -rf "$tree" "$lists"' EXIT
mkdir -p "$top/build-gpu"
if command -v nvcc >/dev/null; then
    build_programs
else
    echo "Without programs: nvcc is not here, so they will be built where the device is" >&2
fi
list_files >"$lists/files"
list_needed >"$lists/needed"
# /lib is /usr/lib.
sed 's|^/lib/|/usr/lib/|' "$lists/files" "$lists/needed" | sort -u |
    tar -C / --no-recursion -c -T - 2>/dev/null | tar -C "$tree" -x
copy_scenes
download nanobind "$tree/wheels"
commit_of "$top" | paste -sd' ' >"$tree/commit"
tar -C "$tree" -czf "$pack" .
echo "$pack: $(($(stat -c %s "$pack") >> 20)) MiB"
if [[ $warp ]]; then
    rm -f "$top"/build-gpu/warp_lang-*.whl
    download warp-lang "$top/build-gpu" --platform "manylinux_2_34_$(uname -m)" --platform "manylinux_2_28_$(uname -m)"
    du -m "$top"/build-gpu/warp_lang-*.whl | awk '{print $2 ": " $1 " MiB"}'
fi
