#pragma once

// Stage `narrow`: which of the pairs that no plane separates do collide. Filters in float32 first, then the exact
// decision; what expansions cannot hold is left for the host.

#include "backends/cuda/device/runtime.h"
#include "backends/cuda/intersections/intersection_records.h"
#include "backends/cuda/stages/layout.h"
#include "filters/intersection/plane_filter.h"
#include "scene/prepared_scene.h"

namespace crumple::cuda {

/// Parameters of kernels that a graph is known by (engine/graph_key.h).
struct IntersectionParameters {
    NarrowPolicy policy;
    friend bool operator==(const IntersectionParameters&, const IntersectionParameters&) = default;
    void forget_places() {}
};

/// Where colliding pairs go. Counting: only their number by first triangle. Filling: to the places that prefix sums of
/// these numbers gave, `bucketed` of them. Any: nowhere, they are only counted, and the first one ends the work. By
/// world: the same for each world, and expansions are left to those without a hit. Otherwise: to a list, with their
/// rank.
struct Hits {
    enum class Mode { list, count, fill, any, by_world };
    Mode mode;
    List<Hit> list;
    unsigned long long* by_first;  ///< n: number of pairs of each first triangle; filling: where its next one goes
    BucketedPair* bucketed;
    WorldHits worlds{};

    /// For has_ended().
    CRUMPLE_HD unsigned long long* end() const { return mode == Mode::any ? list.count : nullptr; }
};

/// `doubles` counts the pairs that float32 leaves undecided.
void narrow(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const Sorted& sorted,
            const RecordRows& records, const Points& points, const Frames& frames, const NarrowPolicy& policy,
            const List<Candidate>& survivors, const List<Candidate>& undecided, const List<Pair>& beyond,
            const Hits& hits, unsigned long long* doubles);

/// Decides pairs that the filters left undecided.
void decide_exactly(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const Sorted& sorted,
                    Neighbours neighbours, IntersectionKind intersections, const List<Candidate>& undecided,
                    const List<Pair>& beyond, const Hits& hits);
/// The same for no pairs, so that the driver reserves the kernel's stacks. All counters are 0.
void reserve_exact_stack(const Geometry& geometry, cudaStream_t stream, Counters* counters);

/// Writes pairs that the host has decided behind the list's first `begin` hits.
void append_hits(const Geometry& geometry, cudaStream_t stream, const Pair* pairs, std::size_t count,
                 unsigned long long begin, const List<Hit>& hits);
/// Counts the list's hits by first triangle anew.
void rank_hits(const Geometry& geometry, cudaStream_t stream, const List<Hit>& hits, unsigned long long* by_first);

/// Adds pairs (in joint numbering, lower id first) that the host has decided.
void add_hits(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const Pair* pairs,
              std::size_t count, const Hits& hits);

}  // namespace crumple::cuda
