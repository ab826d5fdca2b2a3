#!/usr/bin/env bash
# Shows on a machine with a CUDA device that the cuda backend is right, and how fast it is, in under ten minutes:
#   scripts/gpu_check.sh --pack [--warp]                  where packages can be installed: build-gpu/pack.tar.gz
#   scripts/gpu_check.sh [--out FOLDER] [--seconds N]     where the device is; it may be offline
# There nvcc, g++, CMake and Ninja are needed. Libraries and scenes come from the pack, if build-gpu/ was brought along,
# else from the system and from $CRUMPLE_DATA. Steps, each with a budget of seconds: build; tests on the device, in which
# brute force, the cpu backend and answers from outside are the yardsticks; the same bytes in 100 runs; compute-sanitizer;
# benchmark; NVIDIA Warp's boxes in turn with it, if python3 has numpy and Warp or --warp has left its wheel beside the
# pack; ncu on the three kernels that take longest. What is missing or runs out of time is said in a line.
# FOLDER ($OUT, else benchmarks/results) gets check.json, cuda.json, cuda_peers.json, ncu.txt and check.log. Exit status 1
# if a step failed.
set -euo pipefail
top=$(cd "$(dirname "$0")/.." && pwd)
pack=$top/build-gpu/pack.tar.gz
out=${OUT:-$top/benchmarks/results}
limit=570
frames=(scalable-ccd/cloth-ball/frames/cloth_ball92.ply scalable-ccd/cloth-funnel/frames/227.ply
    scalable-ccd/n-body-simulation/frames/balls16_18.ply gt/cloth_ball92.txt gt/cloth_funnel227.txt gt/balls16_18.txt)

usage() { echo "usage: $0 --pack [--warp] | [--out FOLDER] [--seconds N]" >&2; exit 2; }

make_pack() {
    "$top/scripts/install_dependencies.sh" --tests
    tree=$(mktemp -d)  # global: the trap outlives the function
    trap 'rm -rf "$tree" "$tree".list*' EXIT
    local packages=(pkg-config pkgconf pkgconf-bin libpkgconf3 libtbb-dev libhwy-dev libcli11-dev libfmt-dev
        nlohmann-json3-dev libtinygltf-dev libstb-dev libzip-dev libgtest-dev googletest)
    local package
    for package in "${packages[@]}"; do
        dpkg -L "$package" 2>/dev/null || true
    done | grep -E '^/usr/(bin/pkg|include/|lib/|share/(cmake|pkgconfig))' | sort -u |
        while read -r file; do [[ -d $file && ! -L $file ]] || echo "$file"; done >"$tree.list"
    # Of Boost only what is included.
    git -C "$top" grep -ho '#include <boost/[^>]*>' -- src | sort -u >"$tree/boost.cpp"
    echo '#include <boost/version.hpp>' >>"$tree/boost.cpp"
    g++ -std=c++20 -M "$tree/boost.cpp" | tr -s '\\ ' '\n' | grep '^/usr/include/boost/' >>"$tree.list"
    find /usr/include/boost/config -type f >>"$tree.list"
    rm "$tree/boost.cpp"
    # Shared libraries and what they need, but for the C and C++ libraries.
    grep '\.so$' "$tree.list" | while read -r file; do echo "$file" "$file".*; done | tr ' ' '\n' >>"$tree.list.so"
    cat "$tree.list.so" >>"$tree.list"
    xargs -r ldd <"$tree.list.so" 2>/dev/null | sed -n 's/.*=> \(\/[^ ]*\).*/\1/p' |
        grep -Ev '/(libc|libm|libdl|libpthread|librt|libgcc_s|libstdc\+\+)\.so' | sort -u |
        while read -r file; do echo "$file"; readlink -f "$file"; done >>"$tree.list"
    # /lib is /usr/lib.
    sed 's|^/lib/|/usr/lib/|' "$tree.list" | sort -u | tar -C / --no-recursion -c -T - 2>/dev/null | tar -C "$tree" -x
    local data=${CRUMPLE_DATA:-$top/../shared/data} file
    for file in "${frames[@]}"; do
        if [[ -f $data/$file ]]; then
            install -D -m 644 "$data/$file" "$tree/data/$file"
        else
            echo "Without $file: it is not in $data" >&2
        fi
    done
    commit >"$tree/commit"
    mkdir -p "$top/build-gpu"
    tar -C "$tree" -czf "$pack" .
    echo "$pack: $(($(stat -c %s "$pack") >> 20)) MiB"
}

# Beside the pack, not in it: the wheel is many times as large, and not everybody can carry it.
download_warp() {
    rm -f "$top"/build-gpu/warp_lang-*.whl
    if python3 -m pip download --quiet --disable-pip-version-check --no-deps --only-binary=:all: \
        --platform "manylinux_2_34_$(uname -m)" --platform "manylinux_2_28_$(uname -m)" --dest "$top/build-gpu" warp-lang; then
        du -m "$top"/build-gpu/warp_lang-*.whl | awk '{print $2 ": " $1 " MiB"}'
    else
        echo "Without Warp: pip could not download warp-lang" >&2
    fi
}

commit() {
    git -C "$top" rev-parse HEAD 2>/dev/null || { echo unknown; return; }
    [[ -z $(git -C "$top" status --porcelain --untracked-files=no) ]] || echo "with changes"
}

while (($#)); do
    case $1 in
        --pack)
            [[ ${2-} == --warp || $# -eq 1 ]] || usage
            make_pack
            [[ ${2-} != --warp ]] || download_warp
            exit 0 ;;
        --out) out=${2-}; [[ $out ]] || usage; shift 2 ;;
        --seconds) limit=${2-}; [[ $limit =~ ^[0-9]+$ ]] || usage; shift 2 ;;
        *) usage ;;
    esac
done

build=$top/build-device
work=$build/check
rm -rf "$work"
mkdir -p "$work/logs" "$out"
: >"$work/steps"
export PATH=$PATH:/usr/local/cuda/bin

say() { printf '%-22s %-12s %4d s  %s\n' "$1" "$2" "$3" "${4-}"; }
# note NAME RESULT SECONDS [REMARK]: a line for people, and one for check.json.
note() {
    say "$@"
    printf '{"step": "%s", "result": "%s", "seconds": %d, "remark": "%s"}\n' "$1" "$2" "$3" "${4-}" >>"$work/steps"
}
# step NAME SECONDS COMMAND...: runs it within its budget and that of the whole check.
step() {
    local name=$1 budget=$2 begin=$SECONDS status=0
    shift 2
    ((budget <= limit - SECONDS)) || budget=$((limit - SECONDS))
    if ((budget < 3)); then
        note "$name" "no time" 0
        return 1
    fi
    timeout -k 5 "$budget" "$@" >"$work/logs/$name" 2>&1 || status=$?
    local seconds=$((SECONDS - begin)) remark
    remark=$(grep -aE 'Test .*FAILED|FAILED  \]|[1-9][0-9]* FAILED TEST|ERROR SUMMARY|error:|rror \(' "$work/logs/$name" |
        tail -1 | tr -dc '[:alnum:] .:_/()-' | cut -c1-100) || true
    case $status in
        0) note "$name" ok "$seconds" ;;
        124 | 137) note "$name" "out of time" "$seconds" "after its budget of $budget s" ;;
        *)
            # Machines that lend a device do not always lend its counters.
            if grep -qaE 'ERR_NVGPUCTRPERM|LibraryNotLoaded|Device not supported' "$work/logs/$name"; then
                note "$name" "left out" "$seconds" "the machine does not let it: $remark"
                return $not_allowed
            fi
            note "$name" failed "$seconds" "status $status; $remark" ;;
    esac
    return "$status"
}
not_allowed=77
# The same for steps that a machine may forbid.
step_if_allowed() {
    local status=0
    step "$@" || status=$?
    ((status == 0 || status == not_allowed))
}

device=none
finish() {
    device=$(nvidia-smi --query-gpu=name,driver_version --format=csv,noheader 2>/dev/null | head -1) || true
    {
        printf '{"commit": "%s", "device": "%s", "nvcc": "%s", "seconds": %d,\n "steps": [\n' "$version" \
            "${device:-unknown}" "$(nvcc --version 2>/dev/null | grep -o 'V[0-9.]*' | tail -1)" "$SECONDS"
        sed '$!s/$/,/; s/^/  /' "$work/steps"
        echo ' ]}'
    } >"$out/check.json"
    for log in "$work"/logs/*; do
        printf '\n===== %s\n' "${log##*/}"
        tail -n 400 "$log"
    done >"$out/check.log"
    say whole "$1" "$SECONDS" "$out/check.json"
}
give_up() { finish failed; exit 1; }

# The pack.
settings=()
version=$(commit | paste -sd' ')
if [[ -f $pack ]]; then
    libraries=$build/pack
    step unpack 60 sh -c "rm -rf '$libraries' && mkdir -p '$libraries' && tar -C '$libraries' -xzf '$pack'" || give_up
    [[ $version != unknown ]] || version=$(paste -sd' ' "$libraries/commit")  # a copy without its history
    folder=$libraries/usr/lib/$(uname -m)-linux-gnu
    export PKG_CONFIG_PATH=$folder/pkgconfig:$libraries/usr/share/pkgconfig PKG_CONFIG_SYSROOT_DIR=$libraries
    # An old-style RPATH, since libraries of the pack need others of the pack.
    settings+=("-DCMAKE_PREFIX_PATH=$libraries/usr" -DBoost_NO_BOOST_CMAKE=ON "-DCMAKE_LIBRARY_ARCHITECTURE=$(uname -m)-linux-gnu"
        "-DCMAKE_EXE_LINKER_FLAGS=-Wl,-rpath-link,$folder -Wl,-rpath,$folder -Wl,--disable-new-dtags")
    if ! command -v pkg-config >/dev/null; then
        printf '#!/bin/sh\nLD_LIBRARY_PATH=%s exec %s/usr/bin/pkgconf "$@"\n' "$folder" "$libraries" >"$work/pkg-config"
        chmod +x "$work/pkg-config"
        settings+=("-DPKG_CONFIG_EXECUTABLE=$work/pkg-config")
    fi
    export CRUMPLE_DATA=$libraries/data
else
    note unpack "left out" 0 "no build-gpu/pack.tar.gz: the system's packages"
fi

# The build.
for tool in nvcc g++ cmake ninja; do
    command -v "$tool" >/dev/null || { note build failed 0 "$tool is not here"; give_up; }
done
architecture=$(nvidia-smi --query-gpu=compute_cap --format=csv,noheader 2>/dev/null | head -1 | tr -d .) || true
targets=(device_test device_truth_test device_agreement_test crumple_cuda_benchmark crumple_cli)
step configure 60 cmake -G Ninja -S "$top" -B "$build" -DCMAKE_BUILD_TYPE=Release -DCRUMPLE_CUDA=ON \
    "-DCMAKE_CUDA_ARCHITECTURES=${architecture:-90}" -DCRUMPLE_DEVICE_TESTS=ON -DCRUMPLE_BENCHMARKS=ON \
    -DCRUMPLE_TESTS=OFF -DCRUMPLE_EXAMPLES=OFF "${settings[@]}" || give_up
step build 280 ninja -C "$build" "${targets[@]}" || give_up
tests=$build/tests/device
benchmark=$build/benchmarks/crumple_cuda_benchmark
failed=0
step device 20 "$build/cli/crumple" info --devices || failed=1
if grep -q '^none' "$work/logs/device" 2>/dev/null; then
    note device failed 0 "$(tr -dc '[:alnum:] .:_()-' <"$work/logs/device")"
    give_up
fi

# The tests that take seconds.
if step build_portable 60 ninja -C "$build" device_portable_test; then
    step portable 60 "$tests/device_portable_test" --gtest_brief=1 || failed=1
else
    failed=1
fi
step device_test 60 "$tests/device_test" --gtest_brief=1 || failed=1
if [[ -f ${CRUMPLE_DATA:-$top/../shared/data}/gt/cloth_ball92.txt ]]; then
    step truth 60 "$tests/device_truth_test" --gtest_brief=1 \
        --gtest_filter='*cloth_ball92*:*cloth_funnel227*:*balls16_18*' || failed=1
else
    note truth "left out" 0 "no scenes: CRUMPLE_DATA"
fi
CRUMPLE_REPEATS=100 step same_bytes_100_times 40 "$tests/device_test" --gtest_brief=1 \
    --gtest_filter='*same_bytes*' || failed=1

# Side by side what takes longest: brute force against every scene, which keeps the processors busy, and the sanitizers, on
# small scenes.
jobs=()
shards=$(($(nproc) < 8 ? $(nproc) : 8))
# Each process keeps stacks for all threads of the device (docs/cuda.md) and its scenes there.
free=$(nvidia-smi --query-gpu=memory.free --format=csv,noheader,nounits 2>/dev/null | head -1) || true
[[ ! $free =~ ^[0-9]+$ ]] || ((shards * 4096 <= free / 2)) || shards=$((free / 8192 > 0 ? free / 8192 : 1))
for ((shard = 0; shard < shards; ++shard)); do
    GTEST_TOTAL_SHARDS=$shards GTEST_SHARD_INDEX=$shard \
        step "agreement_$shard" 240 "$tests/device_agreement_test" --gtest_brief=1 &
    jobs+=($!)
done
if command -v compute-sanitizer >/dev/null; then
    few='*takes_meshes_of_every_layout:*launches_between_two_meshes:*puts_long_rows_in_order:*forgets_a_launch*'
    for tool in memcheck racecheck initcheck synccheck; do
        step_if_allowed "$tool" 240 compute-sanitizer --tool "$tool" --error-exitcode 9 "$tests/device_test" --gtest_brief=1 \
            --gtest_filter="$few" &
        jobs+=($!)
    done
else
    note sanitizers "left out" 0 "compute-sanitizer is not here"
fi
for job in "${jobs[@]}"; do wait "$job" || failed=1; done

# The benchmark, with the machine to itself.
step benchmark 150 "$benchmark" --commit "$version" --json "$out/cuda.json" || failed=1
[[ ! -s $work/logs/benchmark ]] || cat "$work/logs/benchmark"

# The peer on the same device, boxes only.
scenes=()
for file in "${frames[@]:0:3}"; do
    name=$(basename "$file" .ply)
    [[ ! -f ${CRUMPLE_DATA:-$top/../shared/data}/$file ]] || scenes+=(--scene "$name")
done
wheel=("$top"/build-gpu/warp_lang-*.whl)
if [[ -f ${wheel[0]} ]] && step install_warp 60 python3 -m pip install --quiet --disable-pip-version-check --no-index \
    --no-deps --no-compile --target "$build/warp" --upgrade "${wheel[0]}"; then
    export PYTHONPATH=$build/warp${PYTHONPATH:+:$PYTHONPATH}
fi
if python3 -c 'import numpy, warp; warp.Bvh' 2>/dev/null; then
    step warp 80 python3 "$top/benchmarks/peers_python.py" --on-device --benchmark "$benchmark" "${scenes[@]}" \
        --scene cloth:500000 --json "$out/cuda_peers.json" || failed=1
    [[ ! -s $work/logs/warp ]] || cat "$work/logs/warp"
else
    note warp "left out" 0 "python3 has not both numpy and warp"
fi

# The profiler: every kernel's time first, then what holds back the three that take longest.
scene=cloth_ball92
[[ -f ${CRUMPLE_DATA:-$top/../shared/data}/${frames[0]} ]] || scene=cloth:100000
if command -v ncu >/dev/null && command -v python3 >/dev/null; then
    play=("$benchmark" --profile --scene "$scene")
    status=0
    step ncu_times 40 ncu --csv --print-kernel-base function --clock-control none \
        --metrics gpu__time_duration.sum "${play[@]}" --frames 3 || status=$?
    if ((status == 0)); then
        python3 "$top/scripts/hottest_kernels.py" "$work/logs/ncu_times" >"$work/hottest" || failed=1
        cat "$work/hottest"
        names=$(head -3 "$work/hottest" | awk '{print $1}' | paste -sd'|')
        step ncu 60 ncu --kernel-name-base function -k "regex:^($names)\$" --launch-count 9 --clock-control none \
            --section SpeedOfLight --section LaunchStats --section Occupancy --section MemoryWorkloadAnalysis \
            --section WarpStateStats "${play[@]}" --frames 3 || failed=1
        cat "$work/hottest" "$work/logs/ncu" >"$out/ncu.txt" 2>/dev/null || true
        rm -f "$work/logs/ncu"
    elif ((status != not_allowed)); then
        failed=1
    fi
else
    note ncu "left out" 0 "ncu or python3 is not here"
fi

if ((failed)); then give_up; fi
finish ok
