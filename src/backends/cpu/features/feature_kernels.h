#pragma once

// Inner loops of queries about features (vertices, edges, faces) on the cpu, as tables of functions like those of the
// stages (backends/cpu/stages/kernels.h), by number of time samples: one for proximities, two for impacts. There is one
// pair of tables in plain C++ (feature_kernels_scalar.cpp, from the per-pair sources that host and device share), and
// one for each SIMD instruction set (feature_lanes.cpp). A leaf is a small set of triangles that one sweep searches.
// Its candidates are the pairs of triangles, a row and a column of the sweep, whose boxes overlap (stages/layout.h). A
// test is a pair of features that may belong to the result. No table drops a test that does; tables may differ in the
// other tests that they drop.

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

/// Distance requested in each test, in normalised coordinates, rounded up. If `each` is not null, it points to one
/// distance per test, and `padding` more that may be read; filters move distances along with their tests. Otherwise
/// `all` applies to every test, or `share` times the test's own distance at the start, if that is more.
struct RequestedDistance {
    float all = 0;
    float* each = nullptr;
    float share = 0;

    RequestedDistance(float distance, float share = 0) : all(distance), share(share) {}
    explicit RequestedDistance(float* of_each) : each(of_each) {}
    bool contact() const { return !each && all == 0 && share == 0; }
    template <FeatureKind kind, int moments>
    float of(std::size_t test, const FeatureVectors<moments>& seen) const {
        const float distance = each ? each[test] : all;
        return share > 0 ? std::max(distance, share * most_at_start<kind>(seen)) : distance;
    }
};

/// Pairs of triangles that separate() does not drop, or some of them.
template <int moments>
struct PairsLeft {
    const FeatureRecord<moments>*rows, *columns;
    const std::uint32_t* packed;  ///< for each pair: column << 16 | row, as indices into `columns` and `rows`
    std::size_t count;

    const FeatureRecord<moments>& row(std::size_t i) const { return rows[packed[i] & 0xffff]; }
    const FeatureRecord<moments>& column(std::size_t i) const { return columns[packed[i] >> 16]; }
};

/// List of the tests of one kind that the pairs of a PairsLeft stand for. A test is stored as index of the pair << 4 |
/// the test's bit in TestsOfPair, so there must be fewer than 2^28 pairs.
struct TestList {
    std::uint32_t* test = nullptr;  ///< kernels may write up to `padding` entries past the last one
    std::size_t count = 0;

    std::size_t pair(std::size_t i) const { return test[i] >> 4; }
    unsigned bit(std::size_t i) const { return test[i] & 15; }
};

/// Writes listed test i as a FeatureTest.
template <FeatureKind kind, int moments>
void write_test(const PairsLeft<moments>& pairs, const TestList& listed, std::size_t i, FeatureTest& test) {
    const std::size_t pair = listed.pair(i);
    write_test<kind>(pairs.row(pair), pairs.column(pair), listed.bit(i), test);
}

template <int moments>
struct FeatureKernels {
    using Record = FeatureRecord<moments>;

    /// Computes records and boxes of a leaf's members.
    void (*build)(const BuildInput& input, const SceneFeatures& features, Record* record, Boxes& boxes,
                  LeafBounds& bounds);

    /// Copies record i to sorted[position[i]].
    void (*scatter)(const Record* record, std::int64_t n, const std::int32_t* position, Record* sorted);

    /// Lists in `left` the candidates that no direction separates by more than the gap, packed as column << 16 | row;
    /// returns their number. `record`: by physical row. May write up to `padding` entries past these.
    std::size_t (*separate)(const Record* record, const CandidateChunk& candidates, const NeededGap& gap,
                            std::uint32_t* left);

    /// Lists the tests of pairs. `names`: the representative of each vertex, equal for vertices that welding merges;
    /// null: no vertices are merged.
    void (*list)(const PairsLeft<moments>& pairs, const std::int32_t* names, TestList& vertex_face,
                 TestList& edge_edge);

    /// Indexed by FeatureKind, for vertex_face and edge_edge. Writes the listed tests that the filters do not drop to
    /// `test`, and returns their number. Overwrites the list. `ends`: see BuildInput.
    std::size_t (*filter_list[2])(const PointRows& points, std::int64_t ends, RequestedDistance distance,
                                  const PairsLeft<moments>& pairs, TestList& listed, FeatureTest* test);

    /// Indexed by FeatureKind. Moves the tests that the filters do not drop to the front of `test`, in order, and
    /// returns their number. The last two kinds, vertex_edge and vertex_vertex, are filtered as a vertex and a face
    /// that is collapsed to an edge or a vertex.
    std::size_t (*filter[feature_kinds])(const PointRows& points, std::int64_t ends, RequestedDistance distance,
                                         FeatureTest* test, std::size_t count);
};

/// Kernels of static queries and of queries about motion.
struct FeatureTables {
    FeatureKernels<1> at_rest;
    FeatureKernels<2> moving;

    /// Computes the squared distance of each pair of features in a batch, rounded to nearest. Writes NaN for a pair
    /// that touches, or for which SIMD lanes cannot round the distance with certainty. `squared` must have capacity for
    /// a full vector of lanes past the last pair.
    void (*squared)(const GuessBatch& batch, double* squared);

    template <int moments>
    const FeatureKernels<moments>& of() const {
        if constexpr (moments == 1)
            return at_rest;
        else
            return moving;
    }
};

/// Returns the tables of an instruction set. Throws Error (backend_unavailable) if the build or the machine lacks it.
const FeatureTables& feature_kernels(Simd simd);

/// Returns all tables that both the build and the machine support, the plain ones first, in the order of
/// all_stage_kernels(). For tests.
std::vector<const FeatureTables*> all_feature_kernels();

extern const FeatureTables scalar_features;

}  // namespace crumple::cpu
