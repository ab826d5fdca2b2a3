#pragma once

// Stage `narrow` for feature queries: expands pairs of triangles to tests of feature pairs, drops most of these tests
// by float32 filters, and decides the others, in two steps (feature_decisions.h). Tests that remain open (`beyond`) are
// packed for the host's rational arithmetic.
//
//     survivors --list--> tests, by kind --decide--> open, by kind --close--> beyond
//                                          \-> hits              \-> hits

#include "backends/cuda/device/runtime.h"
#include "backends/cuda/features/feature_parameters.h"
#include "backends/cuda/features/rows_by_kind.h"
#include "backends/cuda/stages/bounds.h"
#include "backends/cuda/stages/layout.h"
#include "backends/cuda/stages/primitive.h"
#include "filters/features/features_to_decide.h"
#include "filters/features/tests_of_pair.h"
#include "scene/prepared_scene.h"

namespace crumple::cuda {

/// Pair of features in the result; `rank`: its index among pairs of the same first feature; `flag` and `value`: those
/// of Decided.
struct RankedHit {
    std::uint32_t first;  ///< in joint numbering (FirstOfKind)
    std::int32_t second;
    std::uint32_t rank, flag;
    double value;
};

struct FeatureHits {
    bool any = false;  ///< true if hits are only counted, and the first one ends the work
    List<RankedHit> list;
    unsigned long long* by_first;  ///< number of hits of each first feature
    FirstOfKind firsts;

    /// Counter for has_ended(), or null.
    CRUMPLE_HD unsigned long long* end() const { return any ? list.count : nullptr; }
};

struct TestLists {
    List<FeatureTest> of[feature_kinds];
};

/// Test that the host has to decide.
struct UnresolvedTest {
    FeatureTest test;
    FeatureKind kind;
};

/// Pairs of triangles that survive the sweep, and their records. The template argument is the number of time samples.
template <int moments>
struct FeatureSurvivors {
    List<Candidate> list;
    const FeatureRecord<moments>* record;
};

/// Lists the tests that the filters leave: of all kinds if there are codimensional edges or points, which the caller
/// lists and which are not simply the triangles' (`all_kinds`), else of vertex_face and edge_edge. `ends`: see Widened
/// (stages/primitive.h).
template <int moments>
void list_tests(const Geometry& geometry, cudaStream_t stream, const FeatureSurvivors<moments>& survivors,
                const PointRows& points, std::int32_t ends, const FeatureConditions& asked, bool all_kinds,
                const TestLists& tests, const FeatureHits& hits, Counters* counters);

/// Decides the listed tests. Tests that need the second step of the decision go to `open`, tests that the host has to
/// decide to `beyond`.
void decide_tests(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene,
                  const FeatureConditions& asked, bool all_kinds, const TestLists& tests, const TestLists& open,
                  const List<UnresolvedTest>& beyond, const FeatureHits& hits);

/// Launches the kernels that need large stacks, on no tests, so that the driver reserves the stacks. All counters must
/// be 0.
void reserve_feature_stacks(const Geometry& geometry, cudaStream_t stream, Counters* counters);

/// Gathers, for `count` tests that the host has to decide, all data that it needs to decide them.
void gather_cases(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene,
                  const FeatureConditions& asked, const UnresolvedTest* tests, std::size_t count,
                  FeaturesToDecide* cases);

/// Writes hits that the host has found into the list, behind its first `begin` hits.
void append_hits(const Geometry& geometry, cudaStream_t stream, const RankedHit* found, std::size_t count,
                 unsigned long long begin, const FeatureHits& hits);

/// Counts and ranks the list's hits by first feature anew.
void rank_hits(const Geometry& geometry, cudaStream_t stream, const FeatureHits& hits);

/// Computes radii of vertices and triangles in normalised coordinates, rounded up. A triangle's is the largest of its
/// corners'.
void normalise_radii(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const SceneBox* box,
                     const double* radii, float* vertex, float* triangle);

/// Computes the inflation for a distance and a share of the initial distance. `radius`: one for each triangle, or null.
void make_inflation(cudaStream_t stream, const SceneBox* box, double distance, double share, const float* radius,
                    Inflation* inflation);

}  // namespace crumple::cuda
