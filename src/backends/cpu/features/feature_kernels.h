#pragma once

// The inner loops of questions about features on the cpu, as tables of functions beside those of the stages
// (backends/cpu/stages/kernels.h): one for each number of moments, nearness knows one, motion two. Plain C++
// (feature_kernels_scalar.cpp, from the per-pair sources that host and device share) and one pair of tables for each
// SIMD instruction set, which overrides it (feature_lanes.cpp). All tables leave what may be an answer.

#include <algorithm>
#include <cstdint>
#include <vector>

#include "backends/cpu/stages/layout.h"
#include "exact/proximity/guess_batch.h"
#include "filters/features/feature_filters.h"
#include "filters/features/separating_direction.h"
#include "filters/features/tests_of_pair.h"
#include "scene/scene_features.h"

namespace crumple::cpu {

/// What is asked of tests, in normalised coordinates, rounded up: one distance of all, or one of each, with `padding`
/// more that may be read; these are moved as the tests are. Or a share of the test's own distance at the start, if that
/// is more.
struct AskedDistance {
    float all = 0;
    float* each = nullptr;
    float share = 0;

    AskedDistance(float distance, float share = 0) : all(distance), share(share) {}
    explicit AskedDistance(float* of_each) : each(of_each) {}
    bool contact() const { return !each && all == 0 && share == 0; }
    template <FeatureKind kind, int moments>
    float of(std::size_t test, const SeenFeatures<moments>& seen) const {
        const float distance = each ? each[test] : all;
        return share > 0 ? std::max(distance, share * most_at_start<kind>(seen)) : distance;
    }
};

/// Some pairs of triangles that separate() has left.
template <int moments>
struct PairsLeft {
    const FeatureRecord<moments>*rows, *columns;
    const std::uint32_t* packed;
    std::size_t count;

    const FeatureRecord<moments>& row(std::size_t i) const { return rows[packed[i] & 0xffff]; }
    const FeatureRecord<moments>& column(std::size_t i) const { return columns[packed[i] >> 16]; }
};

/// The tests of such pairs, fewer than 2^28, of one kind: a pair's place << 4 | the test's bit of TestsOfPair.
struct ListedTests {
    std::uint32_t* test = nullptr;  ///< `padding` more may be written
    std::size_t count = 0;

    std::size_t pair(std::size_t i) const { return test[i] >> 4; }
    unsigned bit(std::size_t i) const { return test[i] & 15; }
};

/// Writes one of them out.
template <FeatureKind kind, int moments>
void write_test(const PairsLeft<moments>& pairs, const ListedTests& listed, std::size_t i, FeatureTest& test) {
    const std::size_t pair = listed.pair(i);
    write_test<kind>(pairs.row(pair), pairs.column(pair), listed.bit(i), test);
}

template <int moments>
struct FeatureKernels {
    using Record = FeatureRecord<moments>;

    /// Records and boxes of a leaf's members.
    void (*build)(const BuildInput& input, const SceneFeatures& features, Record* record, Boxes& boxes,
                  LeafBounds& bounds);

    /// Copies record i to sorted[position[i]].
    void (*scatter)(const Record* record, std::int64_t n, const std::int32_t* position, Record* sorted);

    /// Lists the candidates that no direction separates by more than the gap, packed as column << 16 | row; returns how
    /// many. `record`: by physical row. Writes up to `padding` more.
    std::size_t (*separate)(const Record* record, const CandidateChunk& candidates, const NeededGap& gap,
                            std::uint32_t* left);

    /// Lists the tests of pairs. `names`: what vertices are called where two are compared, or null.
    void (*list)(const PairsLeft<moments>& pairs, const std::int32_t* names, ListedTests& vertex_face,
                 ListedTests& edge_edge);

    /// Of a vertex and a face, and of two edges: writes out the listed tests that may be an answer, and returns how
    /// many. What is listed is not kept. `ends` as in BuildInput.
    std::size_t (*filter_listed[2])(const PointRows& points, std::int64_t ends, AskedDistance distance,
                                    const PairsLeft<moments>& pairs, ListedTests& listed, FeatureTest* test);

    /// By kind, of which the last two are vertices and faces that are edges and vertices: the same of tests that are
    /// written out; moves them to the front, in order, and returns how many.
    std::size_t (*filter[feature_kinds])(const PointRows& points, std::int64_t ends, AskedDistance distance,
                                         FeatureTest* test, std::size_t count);
};

/// For questions at rest, and for steps.
struct FeatureTables {
    FeatureKernels<1> at_rest;
    FeatureKernels<2> moving;

    /// Squared distances of a batch, rounded to nearest, of features that do not touch; NaN where that takes more. Room
    /// for a vector more is needed.
    void (*squared)(const GuessBatch& batch, double* squared);

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
