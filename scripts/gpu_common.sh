# shellcheck shell=bash disable=SC2034,SC2154
# Definitions that gpu_pack.sh and gpu_check.sh share; both source this file. `top` is the checkout.
pack=$top/build-gpu/pack.tar.xz
# Paths of the check's programs in a build folder, and of the program that needs a checkout of cuBQL.
programs=(tests/device/{device_test,device_features_test,device_truth_test,device_agreement_test,device_stages_test}
    tests/device/{device_portable_test,write_hard_soups} benchmarks/crumple_cuda_benchmark cli/crumple)
rival=benchmarks/crumple_cubql_benchmark
# Earlier commit whose benchmark the pack contains as $earlier, to measure both on one device: the first one with right results
# on a device. (Its parent with the code of the first run, 896aa2a, decides pairs wrongly if nvcc 13.0 compiles it.)
earlier_commit=a1b770c8082780855f4b5e464642237be1df7255
earlier=crumple_cuda_benchmark_earlier

# Prints the files of $CRUMPLE_DATA that the pack contains: scenes of the benchmark, exact results of other programs for these
# scenes (gt/), and small scenes on which the outputs of the cpu and cuda backends are compared.
list_real_files() {
    printf '%s\n' scalable-ccd/cloth-ball/frames/cloth_ball{92,93}.ply scalable-ccd/cloth-funnel/frames/{227,228}.ply \
        scalable-ccd/n-body-simulation/frames/balls16_{18,19}.ply gt/{cloth_ball92,cloth_funnel227,balls16_18}.txt \
        gt/balls16_18_welded.pairs.txt meshes/{hull-mask,truck}.obj thingi10k-ember/case016_{a_88566,b_58011}.ply \
        ipc-toolkit-test-data/{two-cubes-intersecting,spike-plane,thick-cloth/t0,thick-cloth/t1}.ply \
        soups/soup_{degenerate,grid,huge32,repeat,tiny64}.ply
}

commit_of() {
    git -C "$1" rev-parse HEAD 2>/dev/null || { echo unknown; return; }
    [[ -z $(git -C "$1" status --porcelain --untracked-files=no) ]] || echo "with changes"
}

# Prints a hash of all sources of the programs and the Python package in folder $1. gpu_check.sh refuses a pack that was made
# from sources with another hash.
sources_of() {
    (cd "$1" && find CMakeLists.txt benchmarks cli cmake include python/crumple python/src scenes src tests -type f \
        \( -name '*.cpp' -o -name '*.cu' -o -name '*.cuh' -o -name '*.h' -o -name '*.cmake' -o -name CMakeLists.txt \
        -o -path 'python/crumple/*.py' \) | LC_ALL=C sort | xargs sha256sum | sha256sum | cut -c1-64)
}
