#!/usr/bin/env bash
# Shows on a machine with a CUDA device that the cuda backend is right, and how fast it is, in one call of under nine minutes:
#   scripts/gpu_check.sh --pack [--warp]                  where packages can be installed: build-gpu/pack.tar.gz
#   scripts/gpu_check.sh [--out FOLDER] [--seconds N] [--programs FOLDER]    where the device is; it may be offline
# The programs come from the pack, if build-gpu/ was brought along, they start and are of these sources; else they are built,
# for which nvcc, g++, CMake and Ninja are needed (libraries and scenes from the pack, or from the system and
# $CRUMPLE_DATA). --programs takes others: those whose device the CPU plays, to try this script.
#
# Steps, each with a budget of seconds, what is wanted most comes first: the backend's tests; the benchmark; every kernel of
# a frame under ncu; the portable tests; answers from outside; the same bytes in 100 runs; NVIDIA Warp's boxes in turn with
# the benchmark; Python on arrays of PyTorch, CuPy and JAX; brute force against every scene; compute-sanitizer. What is
# missing or runs out of time is said in a line.
# FOLDER ($OUT, else benchmarks/results) gets check.json and check.log, which grow step by step, so that a cut leaves what
# was measured, cuda.json, cuda_peers.json, kernels.txt (time, registers and occupancy of each kernel, gaps between them),
# ncu.txt and ncu.ncu-rep. Exit status 1 if a step failed.
set -euo pipefail
top=$(cd "$(dirname "$0")/.." && pwd)
. "$top/scripts/gpu_common.sh"
out=${OUT:-$top/benchmarks/results}
limit=530
bin=''

usage() { echo "usage: $0 --pack [--warp] | [--out FOLDER] [--seconds N] [--programs FOLDER]" >&2; exit 2; }
while (($#)); do
    case $1 in
        --pack) shift; exec "$top/scripts/gpu_pack.sh" "$@" ;;
        --out) out=${2-}; [[ $out ]] || usage; shift 2 ;;
        --seconds) limit=${2-}; [[ $limit =~ ^[0-9]+$ ]] || usage; shift 2 ;;
        --programs) bin=${2-}; [[ -d $bin ]] || usage; shift 2 ;;
        *) usage ;;
    esac
done

build=$top/build-device
work=$build/check
rm -rf "$work"
mkdir -p "$work/logs" "$out"
: >"$work/steps"
: >"$out/check.log"
export PATH=$PATH:/usr/local/cuda/bin
failed=0
not_allowed=77
version=$(commit_of "$top" | paste -sd' ')
device=$(nvidia-smi --query-gpu=name,driver_version --format=csv,noheader 2>/dev/null | head -1) || true
capability=$(nvidia-smi --query-gpu=compute_cap --format=csv,noheader 2>/dev/null | head -1 | tr -d .) || true
compiler=$(nvcc --version 2>/dev/null | grep -o 'V[0-9.]*' | tail -1) || true

# What is known so far.
write_report() {
    {
        printf '{"commit": "%s", "device": "%s", "nvcc": "%s", "programs": "%s", "seconds": %d, "result": "%s",\n "steps": [\n' \
            "$version" "${device:-unknown}" "$compiler" "${origin:-}" "$SECONDS" "$1"
        sed '$!s/$/,/; s/^/  /' "$work/steps"
        echo ' ]}'
    } >"$work/check.$BASHPID"  # steps may run side by side
    mv -f "$work/check.$BASHPID" "$out/check.json"
}
# note NAME RESULT SECONDS [REMARK]: a line for people, and one for check.json.
note() {
    printf '%-22s %-12s %4d s  %s\n' "$1" "$2" "$3" "${4-}"
    printf '{"step": "%s", "result": "%s", "seconds": %d, "at": %d, "remark": "%s"}\n' "$1" "$2" "$3" "$SECONDS" "${4-}" \
        >>"$work/steps"
    write_report "so far"
}
# step NAME SECONDS COMMAND...: runs it within its budget and that of the whole check.
step() {
    local name=$1 budget=$2 begin=$SECONDS status=0 log=$work/logs/$1
    shift 2
    ((budget <= limit - SECONDS)) || budget=$((limit - SECONDS))
    if ((budget < 3)); then
        note "$name" "no time" 0
        return 1
    fi
    timeout -k 5 "$budget" "$@" >"$log" 2>&1 || status=$?
    { printf '\n===== %s\n' "$name"; tail -n 400 "$log"; } >>"$out/check.log"
    local seconds=$((SECONDS - begin)) remark
    remark=$(grep -aE 'Test .*FAILED|FAILED  \]|[1-9][0-9]* (FAILED TEST|failed)|ERROR SUMMARY|error:|rror \(|^none: ' "$log" |
        tail -n 1 | tr -dc '[:alnum:] .:_/()-' | cut -c1-100) || true
    case $status in
        0) note "$name" ok "$seconds" ;;
        124 | 137) note "$name" "out of time" "$seconds" "after its budget of $budget s" ;;
        *)
            # Not every machine lets a program read its device's counters.
            if grep -qaE 'ERR_NVGPUCTRPERM|LibraryNotLoaded|Device not supported' "$log"; then
                note "$name" "left out" "$seconds" "the machine does not let it: $remark"
                return $not_allowed
            fi
            note "$name" failed "$seconds" "status $status; $remark" ;;
    esac
    return "$status"
}
# The same, for steps whose failure is the check's, and those that a machine may forbid.
check() { step "$@" || failed=1; }
check_if_allowed() {
    local status=0
    step "$@" || status=$?
    ((status == 0 || status == not_allowed)) || failed=1
}
finish() {
    write_report "$1"
    printf '%-22s %-12s %4d s  %s\n' whole "$1" "$SECONDS" "$out/check.json"
    [[ $1 == ok ]] || exit 1
}

# The pack.
settings=() origin='' packed=''
if [[ -f $pack ]]; then
    packed=$build/pack
    step unpack 60 sh -c "rm -rf '$packed' && mkdir -p '$packed' && tar -C '$packed' -xzf '$pack'" || finish failed
    [[ $version != unknown ]] || version=$(cat "$packed/commit")  # a copy without its history
    export CRUMPLE_DATA=$packed/data
else
    note unpack "left out" 0 "no build-gpu/pack.tar.gz: the system's packages"
fi
data=${CRUMPLE_DATA:-$top/../shared/data}

# Whether the programs in $bin start and find a device.
find_device() {
    step device 30 bash -c 'set -o pipefail; "$1" info --devices | tee "$2" && ! grep -q "^none" "$2"' - "$bin/crumple" "$work/devices"
}
# Where the programs are, by the pack's word.
use_pack() {
    [[ $packed && -x $packed/bin/crumple ]] || return 1
    local reason=''
    if [[ $(sources_of "$top") != "$(cat "$packed/sources")" ]]; then
        reason="made of other sources"
    elif [[ $capability ]] && ((capability < $(cat "$packed/architecture"))); then
        reason="made for compute capability $(cat "$packed/architecture"), this is $capability"
    fi
    if [[ $reason ]]; then
        note programs "left out" 0 "of the pack: $reason"
        return 1
    fi
    bin=$packed/bin origin=pack
    find_device || return 1
}
# What CMake needs to find the pack's libraries.
set_up_libraries() {
    [[ $packed ]] || return 0
    local folder=$packed/usr/lib/$(uname -m)-linux-gnu
    export PKG_CONFIG_PATH=$folder/pkgconfig:$packed/usr/share/pkgconfig PKG_CONFIG_SYSROOT_DIR=$packed
    # An old-style RPATH, since libraries of the pack need others of the pack.
    settings+=("-DCMAKE_PREFIX_PATH=$packed/usr" -DBoost_NO_BOOST_CMAKE=ON "-DCMAKE_LIBRARY_ARCHITECTURE=$(uname -m)-linux-gnu"
        "-DCMAKE_EXE_LINKER_FLAGS=-Wl,-rpath-link,$folder -Wl,-rpath,$folder -Wl,--disable-new-dtags"
        "-DCMAKE_MODULE_LINKER_FLAGS=-Wl,-rpath-link,$folder -Wl,-rpath,$folder -Wl,--disable-new-dtags")
    # Even where the machine has a pkg-config: CMake would look into the pack first, whose own cannot start without this.
    printf '#!/bin/sh\nLD_LIBRARY_PATH=%s exec %s/usr/bin/pkgconf "$@"\n' "$folder" "$packed" >"$work/pkg-config"
    chmod +x "$work/pkg-config"
    settings+=("-DPKG_CONFIG_EXECUTABLE=$work/pkg-config")
}
configure() {
    cmake -G Ninja -S "$top" -DCMAKE_BUILD_TYPE=Release -DCRUMPLE_CUDA=ON "-DCMAKE_CUDA_ARCHITECTURES=${capability:-90}" \
        -DCRUMPLE_TESTS=OFF -DCRUMPLE_EXAMPLES=OFF "${settings[@]}" "$@"
}
build_here() {
    local tool
    for tool in nvcc g++ cmake ninja; do
        command -v "$tool" >/dev/null || { note build failed 0 "$tool is not here"; return 1; }
    done
    export -f configure
    step configure 60 bash -c "$(declare -p settings top capability); configure -B '$build' -DCRUMPLE_DEVICE_TESTS=ON \
        -DCRUMPLE_BENCHMARKS=ON" || return 1
    step build 280 ninja -C "$build" "${programs[@]}" || return 1
    bin=$build/bin origin=built
    mkdir -p "$bin"
    local program
    for program in "${programs[@]}"; do ln -sf "$build/$program" "$bin/"; done
    find_device
}

set_up_libraries
if [[ $bin ]]; then
    origin=given
    find_device || finish failed
elif ! use_pack; then
    build_here || finish failed
fi
if [[ $device ]]; then
    nvidia-smi -q -d CLOCK,POWER,ECC,COMPUTE >>"$out/check.log" 2>&1 || true
fi
scene=cloth_ball92
[[ -f $data/${frames[0]} ]] || scene=cloth:100000

check device_test 60 "$bin/device_test" --gtest_brief=1
check device_features_test 40 "$bin/device_features_test" --gtest_brief=1

# Figures, with the machine to itself.
check benchmark 150 "$bin/crumple_cuda_benchmark" --commit "$version" --json "$out/cuda.json"
[[ ! -s $work/logs/benchmark ]] || cat "$work/logs/benchmark"

# The profiler: one warm frame. Its caches stay as the kernels before leave them, as in a frame; clocks stay as they are.
profile() {
    local play=("$bin/crumple_cuda_benchmark" --profile --frames 8 --scene "$scene") status=0
    local watch=(ncu --print-kernel-base function --profile-from-start off --cache-control none --clock-control none)
    local metrics=gpu__time_duration.sum,launch__registers_per_thread,launch__grid_size,launch__block_size
    metrics+=,launch__shared_mem_per_block,sm__maximum_warps_per_active_cycle_pct
    metrics+=,sm__warps_active.avg.pct_of_peak_sustained_active,smsp__inst_executed.sum,lts__t_bytes.sum,dram__bytes.sum
    step ncu_kernels 60 "${watch[@]}" --csv --metrics "$metrics" "${play[@]}" || status=$?
    ((status != not_allowed)) || return 0
    if ((status)); then  # one of the metrics may be unknown here
        step ncu_times 40 "${watch[@]}" --csv --metrics gpu__time_duration.sum "${play[@]}" || return 1
        mv "$work/logs/ncu_times" "$work/logs/ncu_kernels"
    fi
    python3 "$top/scripts/kernels_of_a_frame.py" "$work/logs/ncu_kernels" --scene "$scene" --figures "$out/cuda.json" \
        >"$out/kernels.txt" || return 1
    cat "$out/kernels.txt"
    step ncu_sections 60 "${watch[@]}" --force-overwrite --export "$out/ncu.ncu-rep" --section SpeedOfLight \
        --section LaunchStats --section Occupancy --section MemoryWorkloadAnalysis --section WarpStateStats "${play[@]}" ||
        return 1
    timeout 30 ncu --import "$out/ncu.ncu-rep" --page details >"$out/ncu.txt" 2>&1
}
if command -v ncu >/dev/null && command -v python3 >/dev/null; then
    profile || failed=1
else
    note ncu "left out" 0 "ncu or python3 is not here"
fi

# The Python package is built while the device is busy with short tests.
python=()
if [[ $packed ]] && ls "$packed"/wheels/nanobind-*.whl >/dev/null 2>&1; then
    site=$build/site
    build_python() {
        rm -rf "$site" && mkdir -p "$site/crumple" && python3 -m zipfile -e "$packed"/wheels/nanobind-*.whl "$site" &&
            configure -B "$build/python" -DCRUMPLE_PYTHON=ON "-Dnanobind_ROOT=$site/nanobind/cmake" \
                "-DPython_EXECUTABLE=$(command -v python3)" &&
            nice ninja -C "$build/python" crumple_python &&
            cp -r "$top"/python/crumple/. "$build"/python/python/_core*.so "$site/crumple"
    }
    if python3 -c 'import numpy, pytest, torch' 2>/dev/null && command -v nvcc cmake ninja >/dev/null; then
        export -f configure build_python
        step python_build 240 bash -c "set -e; $(declare -p settings top capability packed build site); build_python" &
        python=($!)
    else
        note python "left out" 0 "not all of numpy, pytest, torch for python3, nvcc, cmake, ninja are here"
    fi
else
    note python "left out" 0 "no nanobind in a pack"
fi

check stages 60 "$bin/device_stages_test" --gtest_brief=1
check portable 60 "$bin/device_portable_test" --gtest_brief=1
if [[ -f $data/gt/cloth_ball92.txt ]]; then
    check truth 60 "$bin/device_truth_test" --gtest_brief=1 --gtest_filter='*cloth_ball92*:*cloth_funnel227*:*balls16_18*'
else
    note truth "left out" 0 "no scenes: CRUMPLE_DATA"
fi
CRUMPLE_REPEATS=100 check same_bytes_100_times 40 "$bin/device_test" --gtest_brief=1 --gtest_filter='*same_bytes*'

# Brute force against every scene, which keeps the processors busy: each process keeps stacks for all threads of the device
# (docs/cuda.md) and its scenes there, so they are few.
jobs=()
shards=$(($(nproc) < 3 ? $(nproc) : 3))
for ((shard = 0; shard < shards; ++shard)); do
    GTEST_TOTAL_SHARDS=$shards GTEST_SHARD_INDEX=$shard \
        step "agreement_$shard" 150 "$bin/device_agreement_test" --gtest_brief=1 &
    jobs+=($!)
done
for job in "${jobs[@]}"; do wait "$job" || failed=1; done

if ((${#python[@]})); then
    if wait "${python[0]}"; then
        PYTHONPATH=$site PYTHONDONTWRITEBYTECODE=1 XLA_PYTHON_CLIENT_PREALLOCATE=false check python 60 python3 -m pytest -q -p no:cacheprovider \
            -c "$top/pyproject.toml" --rootdir "$top" "$top/python/tests/test_device.py"
        grep -q ' passed' "$work/logs/python" || { note python failed 0 "no test ran"; failed=1; }
    else
        failed=1
    fi
fi

# The peer on the same device, boxes only.
scenes=()
for file in "${frames[@]:0:3}"; do
    [[ ! -f $data/$file ]] || scenes+=(--scene "$(basename "$file" .ply)")
done
wheel=("$top"/build-gpu/warp_lang-*.whl)
if [[ -f ${wheel[0]} ]] && step install_warp 60 python3 -m pip install --quiet --disable-pip-version-check --no-index \
    --no-deps --no-compile --target "$build/warp" --upgrade "${wheel[0]}"; then
    export PYTHONPATH=$build/warp${PYTHONPATH:+:$PYTHONPATH}
fi
if python3 -c 'import numpy, warp; warp.Bvh' 2>/dev/null; then
    check warp 80 python3 "$top/benchmarks/peers_python.py" --on-device --benchmark "$bin/crumple_cuda_benchmark" \
        "${scenes[@]}" --scene cloth:500000 --json "$out/cuda_peers.json"
    [[ ! -s $work/logs/warp ]] || cat "$work/logs/warp"
else
    note warp "left out" 0 "python3 lacks numpy or warp"
fi

# Last what takes longest for what it may find; on small scenes.
if command -v compute-sanitizer >/dev/null; then
    few='*takes_meshes_of_every_layout:*launches_between_two_meshes:*puts_long_rows_in_order:*forgets_a_launch*'
    for tool in memcheck racecheck synccheck initcheck; do
        check_if_allowed "$tool" 60 compute-sanitizer --tool "$tool" --error-exitcode 9 "$bin/device_test" --gtest_brief=1 \
            --gtest_filter="$few"
        check_if_allowed "${tool}_features" 40 compute-sanitizer --tool "$tool" --error-exitcode 9 \
            "$bin/device_features_test" --gtest_brief=1 --gtest_filter='*have_radii*:*are_read_as_they_lie*'
    done
else
    note sanitizers "left out" 0 "compute-sanitizer is not here"
fi

if ((failed)); then finish failed; fi
finish ok
