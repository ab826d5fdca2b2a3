#pragma once

// Stage `narrow` for questions about features: pairs of triangles stand for tests of features; filters in float32 drop
// most of these, and the others are decided, quickly if that will do, closely if not. What remains open then is packed
// for the host's rational arithmetic.
//
//     survivors --list--> tests, by kind --decide--> open, by kind --close--> beyond
//                                          \-> hits              \-> hits

#include "backends/cuda/device/runtime.h"
#include "backends/cuda/features/feature_parameters.h"
#include "backends/cuda/features/rows_by_kind.h"
#include "backends/cuda/stages/bounds.h"
#include "backends/cuda/stages/layout.h"
#include "backends/cuda/stages/primitive.h"
#include "filters/features/packed_features.h"
#include "filters/features/tests_of_pair.h"
#include "scene/prepared_scene.h"

namespace crumple::cuda {

/// A pair that is an answer; `rank` among those of the same first feature.
struct RankedHit {
    std::uint32_t first;  ///< jointly numbered
    std::int32_t second;
    std::uint32_t rank, flag;
    double value;
};

struct FeatureHits {
    bool any = false;  ///< they are only counted, and the first one ends the work
    List<RankedHit> list;
    unsigned long long* by_first;
    FirstOfKind firsts;

    /// For has_ended().
    CRUMPLE_HD unsigned long long* end() const { return any ? list.count : nullptr; }
};

struct TestLists {
    List<FeatureTest> of[feature_kinds];
};

/// A test that the host has to decide.
struct OpenTest {
    FeatureTest test;
    FeatureKind kind;
};

/// Pairs that survive, in records of so many moments.
template <int moments>
struct FeatureSurvivors {
    List<Candidate> list;
    const FeatureRecord<moments>* record;
};

/// Lists the tests that filters leave. `all_kinds`: edges and points are listed, of any kind; else of two.
template <int moments>
void list_tests(const Geometry& geometry, cudaStream_t stream, const FeatureSurvivors<moments>& survivors,
                const PointRows& points, std::int32_t ends, const AskedOfFeatures& asked, bool all_kinds,
                const TestLists& tests, const FeatureHits& hits, Counters* counters);

/// Decides them.
void decide_tests(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene,
                  const AskedOfFeatures& asked, bool all_kinds, const TestLists& tests, const TestLists& open,
                  const List<OpenTest>& beyond, const FeatureHits& hits);

/// Launches what keeps data on stacks on no tests, so that the driver gives it its stacks. All counters are 0.
void reserve_feature_stacks(const Geometry& geometry, cudaStream_t stream, Counters* counters);

/// All that decisions about open tests take.
void pack_cases(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const AskedOfFeatures& asked,
                const OpenTest* tests, std::size_t count, PackedFeatures* cases);

/// Writes hits that the host has found behind the list's first `begin`.
void append_hits(const Geometry& geometry, cudaStream_t stream, const RankedHit* found, std::size_t count,
                 unsigned long long begin, const FeatureHits& hits);

/// Counts the list's hits by first feature anew.
void rank_hits(const Geometry& geometry, cudaStream_t stream, const FeatureHits& hits);

/// Radii of vertices and triangles in normalised coordinates, rounded up; of a triangle the largest of its corners'.
void normalise_radii(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const SceneBox* box,
                     const double* radii, float* vertex, float* triangle);

/// Of a question that asks for a distance and a share; `radius`: one a triangle, or null.
void make_inflation(cudaStream_t stream, const SceneBox* box, double distance, double share, const float* radius,
                    Inflation* inflation);

}  // namespace crumple::cuda
