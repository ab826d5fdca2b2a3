#!/usr/bin/env bash
# Makes build-gpu/pack.tar.xz, which scripts/gpu_check.sh needs on the machine with the device; needs nvcc but no
# device.
#   scripts/gpu_pack.sh [--python VERSION|PATH] [--cubql PATH] [--warp]
# The pack contains the programs of the check, and the benchmark of an earlier commit (gpu_common.sh), all for $CUDAARCHS
# (default 90: machine code for compute capability 9.0, PTX for later ones) and with line numbers for profilers; their
# libraries; a wheel of the Python package; scenes of $CRUMPLE_DATA.
#   --python  the interpreter that builds the wheel ($CRUMPLE_GPU_PYTHON, else python3.12). From 3.12 on, wheels have the
#             stable ABI: a wheel of 3.12 works in all later versions.
#   --cubql   a checkout or a repository of cuBQL ($CUBQL, else GitHub's), whose BVH is compared with the backend
#   --warp    puts NVIDIA Warp's wheel next to the pack; it is many times as large as the pack
set -euo pipefail
top=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=scripts/gpu_common.sh
. "$top/scripts/gpu_common.sh"
export PATH=$PATH:/usr/local/cuda/bin
build=$top/build-gpu-programs  # not within the pack's folder, which is copied to the other machine as a whole
python=${CRUMPLE_GPU_PYTHON:-python3.12} cubql=${CUBQL-} warp=''
cubql_commit=3a6e0b18a6ed733012c183e333f6b7a1c6e9277f

usage() { echo "usage: $0 [--python VERSION|PATH] [--cubql PATH] [--warp]" >&2; exit 2; }
while (($#)); do
    case $1 in
        --python) python=${2-}; [[ $python ]] || usage; shift 2 ;;
        --cubql) cubql=${2-}; [[ $cubql ]] || usage; shift 2 ;;
        --warp) warp=1; shift ;;
        *) usage ;;
    esac
done
[[ $python != [0-9]* ]] || python=python$python
command -v nvcc >/dev/null || { echo "$0: nvcc is not on the path" >&2; exit 1; }
without() { echo "Without $1: $2" >&2; }

# Sets cubql to a folder with cuBQL's headers, or to an empty string if there are none.
find_cubql() {
    local source=${cubql:-https://github.com/NVIDIA/cuBQL} commit=HEAD
    [[ $cubql ]] || commit=$cubql_commit
    if [[ ! -f $cubql/cuBQL/bvh.h ]]; then  # not a checkout, so a repository to clone
        cubql=$build/cuBQL
        rm -rf "$cubql"
        { timeout 60 git clone --quiet --no-checkout "$source" "$cubql" &&
            git -C "$cubql" checkout --quiet "$commit" -- cuBQL; } 2>/dev/null || true
    fi
    if [[ -f $cubql/cuBQL/bvh.h ]]; then
        programs+=("$rival")
    else
        without cuBQL "cuBQL/bvh.h is missing in $source; set --cubql PATH"
        cubql=''
    fi
}

# Settings of all builds. They link with shared libraries, which the pack contains in lib/, since some systems have no
# position-independent static libraries, which the wheel's module would need.
settings=("CMAKE_CUDA_ARCHITECTURES=${CUDAARCHS:-90}" CMAKE_CUDA_FLAGS=-lineinfo CRUMPLE_CUDA=ON CRUMPLE_BENCHMARKS=ON
    CMAKE_BUILD_WITH_INSTALL_RPATH=ON "CMAKE_INSTALL_RPATH=\$ORIGIN/../lib;\$ORIGIN/../../lib"
    "CMAKE_EXE_LINKER_FLAGS=-Wl,--disable-new-dtags" "CMAKE_MODULE_LINKER_FLAGS=-Wl,--disable-new-dtags")

# Builds the wheel, by pip, and the programs in one build folder, so that the library is compiled only once.
build_programs() {
    local settings=("${settings[@]}" CRUMPLE_DEVICE_TESTS=ON "CRUMPLE_CUBQL=$cubql")
    rm -rf "$build/wheel"
    if "$python" -c 'import venv' 2>/dev/null; then
        [[ $("$build/venv/bin/python" -V 2>/dev/null) == "$("$python" -V)" ]] || "$python" -m venv --clear "$build/venv"
        "$build/venv/bin/python" -m pip install --quiet --disable-pip-version-check 'scikit-build-core>=0.11' 'nanobind>=3' \
            'numpy>=2'
        "$build/venv/bin/python" -m pip --disable-pip-version-check --verbose wheel "$top" --no-build-isolation --no-deps \
            --wheel-dir "$build/wheel" -Cbuild-dir="$build" -Ccmake.args=-GNinja \
            "${settings[@]/#/-Ccmake.define.}" >"$build/wheel.log" 2>&1 || { tail -n 40 "$build/wheel.log" >&2; exit 1; }
    else
        without "the Python package" "$python does not start; set --python"
        cmake -G Ninja -S "$top" -B "$build" -DCMAKE_BUILD_TYPE=Release -DCRUMPLE_TESTS=OFF -DCRUMPLE_EXAMPLES=OFF \
            "${settings[@]/#/-D}" >/dev/null
    fi
    ninja -C "$build" "${programs[@]}"
}

# Builds the benchmark of an earlier commit as $build/$earlier. Does so only once, since the commit does not change.
build_earlier() {
    local folder=$build/earlier
    [[ ! -x $build/$earlier ]] || return 0
    git -C "$top" cat-file -e "$earlier_commit" 2>/dev/null || { without "the earlier commit" "Git does not have it"; return 0; }
    rm -rf "$folder"
    mkdir -p "$folder/source"
    git -C "$top" archive "$earlier_commit" | tar -C "$folder/source" -x
    cmake -G Ninja -S "$folder/source" -B "$folder/build" -DCMAKE_BUILD_TYPE=Release -DCRUMPLE_TESTS=OFF -DCRUMPLE_CLI=OFF \
        -DCRUMPLE_EXAMPLES=OFF "${settings[@]/#/-D}" >/dev/null
    ninja -C "$folder/build" benchmarks/crumple_cuda_benchmark
    cp "$folder/build/benchmarks/crumple_cuda_benchmark" "$build/$earlier"
}

# Fills $tree with the pack's content. Stores the wheel without compression, so that the compression of the pack can make use
# of the code that the wheel and the programs have in common.
fill_tree() {
    local file
    mkdir -p "$tree/bin" "$tree/lib"
    [[ ! -x $build/$earlier ]] || strip -o "$tree/bin/$earlier" "$build/$earlier"
    for file in "${programs[@]}"; do strip -o "$tree/bin/${file##*/}" "$build/$file"; done
    for file in "$build"/wheel/*.whl; do
        [[ ! -f $file ]] || python3 - "$file" "$tree/${file##*/}" <<'END'
import sys, zipfile
with zipfile.ZipFile(sys.argv[1]) as source, zipfile.ZipFile(sys.argv[2], "w", zipfile.ZIP_STORED) as target:
    for entry in source.infolist():
        target.writestr(entry.filename, source.read(entry))
END
    done
    # Copies all shared libraries except those of C, C++ and Linux. ldd does not list oneTBB's allocator, since oneTBB loads it
    # at run time.
    { ldd "$tree"/bin/* "$build"/python/_core*.so 2>/dev/null || true; } | sed -n 's/.*=> \(\/[^ ]*\).*/\1/p' | sort -u |
        grep -Ev '/(libc|libm|libdl|libpthread|librt|libgcc_s|libstdc\+\+)\.so' | while read -r file; do
        cp -L "$file" "$tree/lib"
        [[ $file != */libtbb.so.* ]] || cp -L "${file%/*}"/libtbbmalloc.so.2 "$tree/lib"
    done
    list_real_files | while read -r file; do
        install -D -m 644 "$data/$file" "$tree/data/$file" 2>/dev/null || without "$file" "it is not in $data"
    done
    sources_of "$top" >"$tree/sources"
    commit_of "$top" | paste -sd' ' >"$tree/commit"
    echo "${CUDAARCHS:-90}" | grep -o '[0-9]*' | sort -n | head -1 >"$tree/architecture"
}

"$top/scripts/install_dependencies.sh" --tests
tree=$(mktemp -d) data=${CRUMPLE_DATA:-$top/../shared/data}
trap 'rm -rf "$tree"' EXIT
mkdir -p "$build" "${pack%/*}"
find_cubql
build_programs
build_earlier
fill_tree
# The programs have most of their code in common. xz stores it once if its dictionary is as large as all programs together.
tar -C "$tree" --sort=name -c . | xz -T1 --lzma2=preset=9e,dict=256MiB >"$pack.part"
mv "$pack.part" "$pack"
if [[ $warp ]]; then
    rm -f "${pack%/*}"/warp_lang-*.whl
    python3 -m pip download --quiet --disable-pip-version-check --no-deps --only-binary=:all: --dest "${pack%/*}" \
        --platform "manylinux_2_34_$(uname -m)" --platform "manylinux_2_28_$(uname -m)" warp-lang ||
        without "NVIDIA Warp" "pip could not download it"
fi
du -k "${pack%/*}"/* | awk '{printf "%s: %.1f MiB\n", $2, $1 / 1024}'
