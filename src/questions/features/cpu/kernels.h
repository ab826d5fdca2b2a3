#pragma once

// The inner loops of questions about features on the cpu, as a table of functions beside those of the stages
// (engine/cpu/kernels.h). One table for each number of moments: nearness knows one, motion two.

#include <cstdint>

#include "engine/cpu/layout.h"
#include "model/scene_features.h"
#include "questions/features/tests_of_pair.h"

namespace crumple::cpu {

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

    /// Keeps the tests that may be an answer: moves them to the front, in order, and returns how many. `ends` as in
    /// BuildInput; `distance`: what is asked for, in normalised coordinates, rounded up. May read `padding` more.
    std::size_t (*filter)(const PointRows& points, std::int64_t ends, float distance, FeatureKind kind,
                          FeatureTest* test, std::size_t count);
};

template <int moments>
const FeatureKernels<moments>& scalar_features();

}  // namespace crumple::cpu
