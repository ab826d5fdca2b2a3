#pragma once

// The inner loops of questions about features on the cpu, as tables of functions beside those of the stages
// (engine/cpu/kernels.h): one for each number of moments, nearness knows one, motion two. Plain C++
// (kernels_scalar.cpp, from the per-pair sources that host and device share) and one pair of tables for each SIMD
// instruction set, which overrides it (lanes.cpp). All tables leave what may be an answer.

#include <cstdint>
#include <vector>

#include "engine/cpu/layout.h"
#include "model/scene_features.h"
#include "questions/features/tests_of_pair.h"

namespace crumple::cpu {

/// What is asked of tests, in normalised coordinates, rounded up: one distance of all, or one of each, with `padding`
/// more that may be read; these are moved as the tests are.
struct AskedDistance {
    float all = 0;
    float* each = nullptr;

    AskedDistance(float distance) : all(distance) {}
    explicit AskedDistance(float* of_each) : each(of_each) {}
    float of(std::size_t test) const { return each ? each[test] : all; }
};

template <int moments>
struct FeatureKernels {
    using Record = FeatureRecord<moments>;

    /// Records and boxes of a leaf's members.
    void (*build)(const BuildInput& input, const SceneFeatures& features, Record* record, Boxes& boxes,
                  LeafBounds& bounds);

    /// Copies record i to sorted[position[i]].
    void (*scatter)(const Record* record, std::int64_t n, const std::int32_t* position, Record* sorted);

    /// Lists the candidates that no direction separates by more than `gap`, packed as column << 16 | row; returns how
    /// many. `record`: by physical row. Writes up to `padding` more.
    std::size_t (*separate)(const Record* record, const Candidates& candidates, float gap, std::uint32_t* left);

    /// By kind, of which the last two are vertices and faces that are edges and vertices: keeps the tests that may be
    /// an answer: moves them to the front, in order, and returns how many. `ends` as in BuildInput.
    std::size_t (*filter[feature_kinds])(const PointRows& points, std::int64_t ends, AskedDistance distance,
                                         FeatureTest* test, std::size_t count);
};

/// For questions at rest, and for steps.
struct FeatureTables {
    FeatureKernels<1> at_rest;
    FeatureKernels<2> moving;

    template <int moments>
    const FeatureKernels<moments>& of() const {
        if constexpr (moments == 1)
            return at_rest;
        else
            return moving;
    }
};

/// The tables for an instruction set; throws backend_unavailable if the build or the machine lacks it.
const FeatureTables& feature_kernels(Simd simd);

/// All tables that build and machine have, the plain ones first, in the order of all_stage_kernels(): for tests.
std::vector<const FeatureTables*> all_feature_kernels();

extern const FeatureTables scalar_features;

}  // namespace crumple::cpu
