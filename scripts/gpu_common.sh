# Sourced by gpu_pack.sh and gpu_check.sh: what both must agree on. `top` is the checkout.
pack=$top/build-gpu/pack.tar.gz
# Real scenes, and answers from outside.
frames=(scalable-ccd/cloth-ball/frames/cloth_ball92.ply scalable-ccd/cloth-funnel/frames/227.ply
    scalable-ccd/n-body-simulation/frames/balls16_18.ply gt/cloth_ball92.txt gt/cloth_funnel227.txt gt/balls16_18.txt
    gt/balls16_18_welded.pairs.txt scalable-ccd/cloth-ball/frames/cloth_ball93.ply scalable-ccd/cloth-funnel/frames/228.ply
    scalable-ccd/n-body-simulation/frames/balls16_19.ply)
# The check's programs, where a build folder has them.
programs=(tests/device/device_test tests/device/device_features_test tests/device/device_truth_test tests/device/device_agreement_test
    tests/device/device_stages_test tests/device/device_portable_test benchmarks/crumple_cuda_benchmark cli/crumple)

commit_of() {
    git -C "$1" rev-parse HEAD 2>/dev/null || { echo unknown; return; }
    [[ -z $(git -C "$1" status --porcelain --untracked-files=no) ]] || echo "with changes"
}

# One word for all that the programs are made of: a pack made of other sources is not to be taken for these.
sources_of() {
    (cd "$1" && find CMakeLists.txt benchmarks cli cmake include scenes src tests -type f \
        \( -name '*.cpp' -o -name '*.cu' -o -name '*.cuh' -o -name '*.h' -o -name '*.cmake' -o -name CMakeLists.txt \) |
        LC_ALL=C sort | xargs sha256sum | sha256sum | cut -c1-64)
}
