# shellcheck shell=bash disable=SC2154
# Steps of gpu_check.sh. The shell of each step sources this file and inherits variables. Folders: $bin with the programs, $data
# with the files of $CRUMPLE_DATA, $work with files passed between steps, $out for results. $log is the file of the step's
# output, $budget its time limit in seconds.
# shellcheck source=scripts/gpu_common.sh
. "$top/scripts/gpu_common.sh"

remark() { echo "remark: $*"; }  # the last remark is shown with the step's result
leave_out() { remark "$*"; exit "$left_out"; }
need() { command -v "$1" >/dev/null || leave_out "$1 is not here"; }

unpack() {
    rm -rf "$packed"
    mkdir -p "$packed/site"
    tar -C "$packed" -xJf "$pack" || python3 -m tarfile -e "$pack" "$packed"
    [[ $(sources_of "$top") == "$(cat "$packed/sources")" ]] || { remark "the pack is made of other sources; --pack makes a new one"; exit 1; }
    for wheel in "$packed"/*.whl; do
        [[ ! -f $wheel ]] || python3 -m zipfile -e "$wheel" "$packed/site"
    done
    remark "made of $(cat "$packed/commit") for compute capability $(cat "$packed/architecture") and later"
}
version_of() { "$@" 2>/dev/null | grep -oE '[0-9]+\.[0-9]+(\.[0-9]+)*' | tail -n 1 || echo none; }
show_info() {
    local packages='' name
    nvidia-smi -q -d CLOCK,POWER,ECC,COMPUTE,MEMORY || true
    packages=$(python3 - <<'END' || echo "no python3"
import importlib.metadata, sys
here = {d.metadata["Name"].lower(): d.version for d in importlib.metadata.distributions() if d.metadata["Name"]}
print("python3", sys.version.split()[0] + "".join(f", {name} {here[name]}" for name in sorted(here) if name in
      ("numpy", "pytest", "torch", "jax", "cupy-cuda13x", "cupy-cuda12x", "warp-lang")))
END
    )
    "$bin/crumple" info --devices | tee "$work/devices"
    remark "$(head -n 1 "$work/devices"), driver $(version_of nvidia-smi --query-gpu=driver_version --format=csv,noheader)," \
        "$(for name in nvcc ncu compute-sanitizer; do echo -n "$name $(version_of "$name" --version), "; done)$packages"
    ! grep -q '^none' "$work/devices"
}
# Runs a search on the cuda backend. The backend's constructor compares decisions of the device with those of the host, and
# throws if they differ. crumple then fails: it does not use the cpu backend instead, because --backend names cuda.
find_known_answers() {
    local begin
    "$bin/write_hard_soups" "$work/soups"
    begin=${EPOCHREALTIME/./}
    "$bin/crumple" detect "$work/soups/grid.ply" --backend cuda -o "$work/grid.csv"
    remark "first call of a process: $(((${EPOCHREALTIME/./} - begin) / 1000)) ms"
}

# Runs a program's tests in several processes. Then repeats up to ten that did not pass, one process each, because a
# device error persists in its process and fails all later tests. Runs the first one that fails again also under memcheck.
run_tests() {  # PROGRAM PROCESSES
    local program=$bin/$1 shard again count test alone=0 first='' memory=''
    [[ -x $program ]] || leave_out "no $1 in $bin"
    "$program" --gtest_list_tests | awk '/^[^ ]/ {suite = $1} /^ / && !/DISABLED_/ {print suite $1}' | sort >"$log.listed"
    for ((shard = 0; shard < $2; ++shard)); do
        GTEST_TOTAL_SHARDS=$2 GTEST_SHARD_INDEX=$shard timeout -k 2 $((2 * budget / 3)) "$program" >"$log.$shard" 2>&1 &
    done
    wait
    cat "$log".[0-9]
    again=$(sed -nE 's/^\[ +(OK|SKIPPED) +\] ([^ ,]+).*/\2/p' "$log".[0-9] | sort -u | comm -23 "$log.listed" -)
    count=$(wc -l <"$log.listed")
    remark "$count tests passed, in $2 processes"
    [[ $again ]] || return 0
    count="$(wc -l <<<"$again") of $count tests failed"
    for test in $(head -n 10 <<<"$again"); do
        remark "$count, $alone of them also alone${first:+: $first${memory:+, memcheck: $memory}}"
        if timeout -k 2 $((budget / 4)) "$program" --gtest_filter="$test"; then continue; fi
        alone=$((alone + 1))
        [[ ! $first ]] || continue
        first=$test
        memory=$(timeout -k 2 $((budget / 3)) compute-sanitizer --tool memcheck --report-api-errors all "$program" \
            --gtest_filter="$test" 2>&1 | tee /dev/stderr | sed -n 's/.*ERROR SUMMARY: //p') || memory=${memory:-did not run}
    done
    remark "$count, $alone of the first ten also alone: ${first:-$(head -n 1 <<<"$again")}${memory:+, memcheck: $memory}"
    return 1
}

# Prints calls of the command line, one per line; paths of files are relative to $CRUMPLE_DATA.
list_calls() {
    local soup
    for soup in "$work"/soups/*.ply; do
        echo "detect $soup --contacts"
        echo "impacts $soup $work/soups/moved/${soup##*/}"
        [[ $soup == *_tenths.ply ]] || echo "near $soup --radius 0.5"
    done
    echo "detect meshes/hull-mask.obj --contacts"
    echo "detect thingi10k-ember/case016_a_88566.ply thingi10k-ember/case016_b_58011.ply --contacts"
    echo "impacts scalable-ccd/cloth-funnel/frames/227.ply scalable-ccd/cloth-funnel/frames/228.ply"
}
list_real_calls() {
    list_real_files | sed -n 's/.*\.\(ply\|obj\)$/detect & --contacts/p'
    echo "impacts ipc-toolkit-test-data/thick-cloth/t0.ply ipc-toolkit-test-data/thick-cloth/t1.ply"
    echo "impacts scalable-ccd/cloth-ball/frames/cloth_ball92.ply scalable-ccd/cloth-ball/frames/cloth_ball93.ply"
    echo "near scalable-ccd/cloth-funnel/frames/227.ply --radius 0.01"
}
# Reads calls of the command line, and compares the output files of the cpu and the cuda backend for each.
compare_bytes() {
    export -f compare_call
    cd "$(readlink -e "$data" || echo "$work")" || exit
    # shellcheck disable=SC2016
    head -n "$most_calls" | xargs -d '\n' -n 1 -P 8 bash -c 'compare_call $1' - | tee "$log.calls"
    remark "$(awk '/^same/ {++calls; lines += $2} END {print calls + 0, "calls have the same bytes,", lines + 0, "lines"}' \
        "$log.calls"); $(grep -c ^other "$log.calls") differ: $(grep -m 1 ^other "$log.calls" | sed "s|$work/soups/||g")"
    ! grep -q ^other "$log.calls"
}
compare_call() {
    local word backend part=$work/bytes.$BASHPID
    for word; do
        if [[ $word == *.@(ply|obj) && ! -f $word ]]; then echo "left out, no $word"; return; fi
    done
    for backend in cpu cuda; do
        "$bin/crumple" "$@" --backend "$backend" -o "$part.$backend.csv" || echo "error: $? of $backend: $*"
    done
    if cmp "$part.cpu.csv" "$part.cuda.csv"; then echo "same $(wc -l <"$part.cpu.csv") lines: $*"; else echo "other: $*"; fi
    rm -f "$part".*
}

benchmark() {  # FILE OPTIONS
    local file=$out/$1 status=0
    shift
    "$bin/crumple_cuda_benchmark" --commit "$version" --json "$file" "$@" || status=$?
    python3 - "$file" <<'END' || true
import json, sys
rows = json.load(open(sys.argv[1]))["scenes"]
print("remark:", "; ".join(f"{row['scene']} {row['device']['median']:.3f} ms, cpu {row['cpu_all_threads']['median']:.3f}"
                           + ("" if row["right"] else ", WRONG") for row in rows))
END
    return "$status"
}
# Measures some scenes and steps by the benchmarks of this and of the earlier commit, one after the other, and prints the
# ratio of their times on the device. Goals: see docs/cuda.md.
compare_with_earlier_commit() {
    local program
    [[ -x $bin/$earlier ]] || leave_out "built without the earlier commit"
    for program in "$earlier" crumple_cuda_benchmark; do
        # shellcheck disable=SC2046,SC2086
        "$bin/$program" --largest 0 --worlds 0 $(printf ' --scene %s' $scenes) $(printf ' --step %s' $steps) \
            ${frames:---frames 60} --json "$work/$program.json"
    done
    python3 - "$work" "$earlier" "$out/ratios.json" <<'END'
import json, sys
from pathlib import Path
folder, earlier, out = sys.argv[1:]
GOALS = {("cloth_ball92", "intersections"): 0.57, ("227", "intersections"): 0.69, ("balls16_18", "intersections"): 0.66,
         ("unc_cloth_ball", "impacts"): 0.63, ("unc_n_body", "candidates"): 0.13}
def times(program):
    figures = json.loads(Path(folder, program + ".json").read_text())
    rows = [((row["scene"], "intersections"), row) for row in figures["scenes"]]
    rows += [((row["step"], row["question"]), row) for row in figures["steps"]]
    return {name: row["device"]["median"] for name, row in rows}
before, after = times(earlier), times("crumple_cuda_benchmark")
rows = [{"scene": name[0], "query": name[1], "earlier": before[name], "now": after[name], "ratio": after[name] / before[name],
         "goal": GOALS.get(name)} for name in after if name in before]
Path(out).write_text(json.dumps({"unit": "milliseconds on the device, medians", "rows": rows}, indent=1) + "\n")
for row in rows:
    print("{scene} {query}: {now:.3f} / {earlier:.3f} ms = {ratio:.3f}".format(**row), f"(goal {row['goal']})" if row["goal"] else "")
shown = [row for row in rows if row["goal"]] or rows
print("remark:", "; ".join(f"{row['scene']} {row['query']} {row['ratio']:.2f}" + (f" (goal {row['goal']})" if row["goal"] else "")
                           for row in shown))
END
}
run_rival() {
    local program=$bin/${rival##*/}
    [[ -x $program ]] || leave_out "built without cuBQL"
    # shellcheck disable=SC2086
    "$program" $scenes | tee "$log.rows"
    { echo '{"unit": "milliseconds", "scenes": ['; sed '$!s/$/,/' "$log.rows"; echo ']}'; } >"$out/cubql.json"
    remark "$(sed -E 's/.*"scene": "([^"]*)".*"median": ([0-9.]*).*/\1 \2 ms/' "$log.rows" | paste -sd';'), boxes only"
}

# Profiles the kernels of the last of eight frames. ncu does not clear caches before a kernel, so that they contain what earlier
# kernels of the frame left there, and does not lock clocks.
profile() {  # OPTIONS of ncu
    need ncu
    ncu --print-kernel-base function --profile-from-start off --cache-control none --clock-control none "$@" \
        "$bin/crumple_cuda_benchmark" --profile --frames 8 --scene "$scene" --step none
}
profile_kernels() {
    local metrics=gpu__time_duration.sum,launch__registers_per_thread,launch__grid_size,launch__block_size
    metrics+=,launch__shared_mem_per_block,sm__maximum_warps_per_active_cycle_pct,smsp__inst_executed.sum,lts__t_bytes.sum
    metrics+=,sm__warps_active.avg.pct_of_peak_sustained_active,dram__bytes.sum
    # A device may not support all metrics.
    profile --csv --metrics "$metrics" || profile --csv --metrics gpu__time_duration.sum
    python3 "$top/scripts/kernels_of_a_frame.py" "$log" --scene "$scene" --figures "$out/cuda_first.json" >"$out/kernels.txt"
    cat "$out/kernels.txt"
    remark "$(grep ' kernels: ' "$out/kernels.txt")"
}
profile_sections() {
    profile --force-overwrite --export "$out/ncu.ncu-rep" --section SpeedOfLight --section LaunchStats --section Occupancy \
        --section MemoryWorkloadAnalysis --section WarpStateStats --section SourceCounters
    ncu --import "$out/ncu.ncu-rep" --page details >"$out/ncu.txt"
    remark ncu.txt
}

run_python_tests() {
    [[ -d $packed/site/crumple ]] || leave_out "no wheel in a pack"
    python3 -c 'import numpy, pytest, torch' || leave_out "not all of numpy, pytest and torch are here"
    PYTHONPATH=$packed/site PYTHONDONTWRITEBYTECODE=1 XLA_PYTHON_CLIENT_PREALLOCATE=false python3 -m pytest -q \
        -p no:cacheprovider -c "$top/pyproject.toml" --rootdir "$top" "$top/python/tests/test_device.py"
    remark "$(tail -n 1 "$log")"
    grep -q ' passed' "$log"
}
# Compares the speed of finding overlapping boxes with NVIDIA Warp, if Warp is installed or its wheel is next to the pack.
race_warp() {
    local wheel=("$top"/build-gpu/warp_lang-*.whl)
    [[ ! -f ${wheel[0]} ]] || python3 -m zipfile -e "${wheel[0]}" "$work/warp"
    export PYTHONPATH=$work/warp${PYTHONPATH:+:$PYTHONPATH}
    python3 -c 'import numpy, warp; warp.Bvh' || leave_out "python3 has no numpy or no warp"
    # shellcheck disable=SC2046,SC2086
    python3 "$top/benchmarks/peers_python.py" --on-device --benchmark "$bin/crumple_cuda_benchmark" \
        $(printf ' --scene %s' $scenes) --json "$out/cuda_peers.json"
}
sanitize() {  # TOOL
    need compute-sanitizer
    local tests long=':*pairs_of_one_triangle_are_sorted'
    [[ $1 != racecheck ]] || long=''  # racecheck takes two minutes for this test
    for tests in device_test:"*hard_soups_in_device_memory*:*Launch.two_meshes_*:*wait_of_launches_in_flight*$long" \
        device_features_test:'*radii_and_rest_shape*:*strided_and_unaligned*'; do
        compute-sanitizer --tool "$1" --error-exitcode 9 "$bin/${tests%%:*}" --gtest_brief=1 --gtest_filter="${tests#*:}"
    done
    remark "$(grep -a 'SUMMARY' "$log" | tail -n 1)"
}
