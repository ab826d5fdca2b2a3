#pragma once

// Stage `narrow` for intersections: decides which of the pairs that no plane separates collide. Filters come first,
// then the exact decision; pairs that expansions cannot decide are left to the host.

#include "backends/cuda/device/runtime.h"
#include "backends/cuda/intersections/intersection_records.h"
#include "backends/cuda/stages/layout.h"
#include "filters/intersection/plane_filter.h"
#include "scene/prepared_scene.h"

namespace crumple::cuda {

/// Kernel parameters that are part of a graph's key (engine/graph_key.h).
struct IntersectionParameters {
    NarrowPolicy policy;
    friend bool operator==(const IntersectionParameters&, const IntersectionParameters&) = default;
    void forget_places() {}
};

/// Output of `narrow`: how colliding pairs are recorded. Mode::count: only counted, by first triangle. Mode::fill:
/// written to `bucketed`, to places given by the prefix sums of these counts. Mode::any: only counted, and the first
/// one ends the work. Mode::by_world: only counted, for each world, and worlds with a hit skip the exact decision.
/// Mode::list: listed, with their ranks.
struct Hits {
    enum class Mode { list, count, fill, any, by_world };
    Mode mode;
    List<Hit> list;
    unsigned long long* by_first;  ///< by first triangle: number of pairs; for Mode::fill: place of its next pair
    BucketedPair* bucketed;
    WorldHits worlds{};

    /// Counter for has_ended(), or null.
    CRUMPLE_HD unsigned long long* end() const { return mode == Mode::any ? list.count : nullptr; }
};

/// Runs the filters and the exact decision. `doubles` counts the pairs that need the float64 filter, because float32
/// does not decide them.
void narrow(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const Sorted& sorted,
            const RecordRows& records, const Points& points, const Frames& frames, const NarrowPolicy& policy,
            const List<Candidate>& survivors, const List<Candidate>& undecided, const List<Pair>& beyond,
            const Hits& hits, unsigned long long* doubles);

/// Decides pairs that the filters left undecided; lists in `beyond` those that expansions cannot decide.
void decide_exactly(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const Sorted& sorted,
                    Neighbours neighbours, IntersectionKind intersections, const List<Candidate>& undecided,
                    const List<Pair>& beyond, const Hits& hits);
/// Launches the exact decision on no pairs, so that the driver reserves the kernel's stacks. All counters must be 0.
void reserve_exact_stack(const Geometry& geometry, cudaStream_t stream, Counters* counters);

/// Writes pairs that the host has decided into the list, behind its first `begin` hits.
void append_hits(const Geometry& geometry, cudaStream_t stream, const Pair* pairs, std::size_t count,
                 unsigned long long begin, const List<Hit>& hits);
/// Counts and ranks the list's hits by first triangle anew.
void rank_hits(const Geometry& geometry, cudaStream_t stream, const List<Hit>& hits, unsigned long long* by_first);

/// Records colliding pairs that the host has found, lower id first; the triangles of a second mesh are numbered after
/// those of the first.
void add_hits(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const Pair* pairs,
              std::size_t count, const Hits& hits);

}  // namespace crumple::cuda
