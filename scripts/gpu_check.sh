#!/usr/bin/env bash
# Tests the cuda backend on a machine with a CUDA device, which may be offline, and measures its speed.
#   scripts/gpu_check.sh --pack [OPTIONS]   to be run first, on a machine with nvcc: makes the pack of programs and
#                                           data, build-gpu/pack.tar.xz (scripts/gpu_pack.sh)
#   scripts/gpu_check.sh --first            the most important steps, within 150 seconds
#   scripts/gpu_check.sh --all              these and all others, within 360 seconds
#     --out FOLDER       folder for results; default: $OUT, else benchmarks/results
#     --seconds N        another limit
#     --programs FOLDER  uses the programs in FOLDER, not those of the pack: for example programs for an emulated
#                        device, to try this script
#
# First unpacks the pack and prints information about the device; if this fails, nothing else runs. Then runs the steps
# of the tables below in order. If one of these fails, the others still run. A step is left out, with a line about it,
# if a tool, package, program or permission that it needs is missing. The folder for results gets:
#   check.json, check.log           results of the steps; both grow step by step, so an aborted run leaves its results
#   cuda_first.json, cuda.json      figures of crumple
#   ratios.json                     times divided by those of an earlier commit (gpu_common.sh), both measured in this run
#   cubql.json                      figures of cuBQL
#   cuda_peers.json                 figures of NVIDIA Warp
#   kernels.txt                     time, registers and occupancy of each kernel in one frame of the benchmark, and by
#                                   how much the frame takes longer than its kernels
#   ncu.txt, ncu.ncu-rep            reports of Nsight Compute
# Exit status 1 if a step failed or ran out of time.
set -euo pipefail
top=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=scripts/gpu_common.sh
. "$top/scripts/gpu_common.sh"

# Steps: NAME SECONDS COMMAND. Adjacent steps marked by & run in parallel.
list_first_steps() {
    cat <<'END'
known_answers           20 find_known_answers
& device_test           45 run_tests device_test 4
& device_features_test  45 run_tests device_features_test 2
bytes                   60 list_calls | compare_bytes
ratios                  60 compare_with_earlier_commit
figures                 40 benchmark cuda_first.json --scene "$scene" --largest 0 --worlds 0 --step none $frames
rival                   20 run_rival
profile                 60 profile_kernels
END
}
list_other_steps() {
    cat <<'END'
all_figures            110 benchmark cuda.json $frames $small
& portable              60 run_tests device_portable_test 1
& stages                60 run_tests device_stages_test 1
& truth                 60 GTEST_FILTER='*cloth_ball92*:*cloth_funnel227*:*balls16_18*' run_tests device_truth_test 1
& agreement             90 run_tests device_agreement_test 4
& same_bytes            60 CRUMPLE_REPEATS=100 GTEST_FILTER='*same_bytes*' run_tests device_test 1
bytes_of_real_scenes    60 list_real_calls | compare_bytes
python                  60 run_python_tests
warp                    60 race_warp
& memcheck              60 sanitize memcheck
& racecheck             90 sanitize racecheck
& synccheck             60 sanitize synccheck
& initcheck             60 sanitize initcheck
ncu_sections            60 profile_sections
END
}

usage() { echo "usage: $0 --pack [OPTIONS] | --first | --all [--out FOLDER] [--seconds N] [--programs FOLDER]" >&2; exit 2; }
mode='' out=${OUT:-$top/benchmarks/results} limit='' bin='' packed=''
while (($#)); do
    case $1 in
        --pack) shift; exec "$top/scripts/gpu_pack.sh" "$@" ;;
        --first | --all) mode=${1#--}; shift ;;
        --out) out=${2-}; [[ $out ]] || usage; shift 2 ;;
        --seconds) limit=${2-}; [[ $limit =~ ^[0-9]+$ ]] || usage; shift 2 ;;
        --programs) bin=${2-}; [[ -d $bin ]] || usage; bin=$(cd "$bin" && pwd); shift 2 ;;
        *) usage ;;
    esac
done
case $mode in
    first) limit=${limit:-150} ;;
    all) limit=${limit:-360} ;;
    *) usage ;;
esac
work=$top/build-device/check data=${CRUMPLE_DATA:-$top/../shared/data}
left_out=77  # exit status of a step that cannot run on this machine
rm -rf "$work"
mkdir -p "$work/logs" "$out"
out=$(cd "$out" && pwd)
: >"$work/steps"
: >"$out/check.log"
version=$(commit_of "$top" | paste -sd' ') device=unknown

# Rewrites check.json. RESULT: "so far" while steps remain, at the end "ok" or "failed".
write_report() {  # RESULT
    {
        printf '{"mode": "%s", "commit": "%s", "device": "%s", "seconds": %d, "result": "%s",\n "steps": [\n' \
            "$mode" "$version" "$device" "$SECONDS" "$1"
        sed '$!s/$/,/; s/^/  /' "$work/steps"
        echo ' ]}'
    } >"$work/check.$BASHPID"  # steps may run in parallel
    mv -f "$work/check.$BASHPID" "$out/check.json"
}
# Prints the result of a step as a line, and adds it to check.json.
note() {  # NAME RESULT SECONDS REMARK
    printf '%-22s %-12s %4d s  %s\n' "$1" "$2" "$3" "$4"
    printf '{"step": "%s", "result": "%s", "seconds": %d, "at": %d, "remark": "%s"}\n' "$1" "$2" "$3" "$SECONDS" "$4" \
        >>"$work/steps"
    write_report "so far"
}
# Prints the last remark in a step's log or, if the step failed without a remark, the log's last line about an error.
remark_of() {  # LOG RESULT
    { sed -n 's/^remark: //p' "$1" | tail -n 1 | grep . ||
        { [[ $2 == ok ]] || grep -aE 'rror|FAILED|[0-9] failed' "$1" || tail -n 1 "$1"; } | tail -n 1; } |
        tr -dc '[:alnum:] .,:;_/()+%-' | tr -s ' ' | cut -c1-300
}
# Runs the command of a step, for at most SECONDS and at most the time that is left to the whole check. Records its result.
step() {  # NAME SECONDS COMMAND
    local name=$1 begin=$SECONDS status=0 result=failed
    local -x budget=$2 log=$work/logs/$1
    ((budget <= limit - SECONDS)) || budget=$((limit - SECONDS))
    if ((budget < 3)); then note "$name" "no time" 0 ""; return; fi
    timeout -k 5 "$budget" bash -euo pipefail -c ". \"\$top/scripts/gpu_steps.sh\"; $3" >"$log" 2>&1 </dev/null || status=$?
    { printf '\n===== %s\n' "$name"; tail -n 400 "$log"; } >>"$out/check.log"
    # Leaves out a step if the machine does not permit programs to read the device's performance counters.
    if ((status)) && grep -qaE 'ERR_NVGPUCTRPERM|LibraryNotLoaded|Device not supported' "$log"; then status=$left_out; fi
    case $status in
        0) result=ok ;;
        "$left_out") result="left out" ;;
        124 | 137) result="out of time" ;;
    esac
    note "$name" "$result" $((SECONDS - begin)) "$(remark_of "$log" "$result" || true)"
}
run_steps() {  # reads a table of steps from standard input
    local name seconds command
    while read -r name seconds command; do
        if [[ $name == '&' ]]; then
            step "$seconds" "${command%% *}" "${command#* }" &
        else
            wait
            step "$name" "$seconds" "$command"
        fi
    done
    wait
}
has_failed() { grep -qE '"result": "(failed|out of time|no time)"' "$work/steps"; }
finish() {
    local result=ok
    ! has_failed || result=failed
    write_report "$result"
    printf '%-22s %-12s %4d s  %s\n' whole "$result" "$SECONDS" "$out/check.json"
    if [[ $result == ok ]]; then exit 0; else exit 1; fi
}

# Variables that the shells of the steps inherit.
export top out work left_out version data packed bin scene scenes steps frames small most_calls CRUMPLE_DATA PATH=$PATH:/usr/local/cuda/bin
scene=cloth_ball92 scenes='cloth_ball92 227 balls16_18' steps='unc_cloth_ball unc_n_body' frames='' small='' most_calls=1000
if [[ -f $pack ]]; then
    packed=$top/build-device/pack data=$top/build-device/pack/data
    step unpack 60 unpack
    ! has_failed || finish
    [[ $version != unknown ]] || version=$(cat "$packed/commit")  # unknown in a copy without Git history
elif [[ ! $bin ]]; then
    note unpack failed 0 "build-gpu/pack.tar.xz is missing; --pack makes it"
    finish
fi
[[ -f $data/scalable-ccd/cloth-ball/frames/cloth_ball92.ply ]] || scene=cloth:100000 scenes=$scene steps=cloth:100000
# Measures a small scene and makes few calls if --programs is given, because an emulated device is slow.
if [[ $bin ]]; then
    scene=cloth:300@40 scenes=$scene steps=cloth:300 frames='--frames 2' most_calls=8
    small="--scene $scene --largest 0 --worlds 3 --step cloth:300"
fi
bin=${bin:-$packed/bin} CRUMPLE_DATA=$data
step info 20 show_info
device=$(head -n 1 "$work/devices" | tr -dc '[:alnum:] .,:;_/()+-')
! has_failed || finish
run_steps < <(list_first_steps)
[[ $mode == first ]] || run_steps < <(list_other_steps)
finish
