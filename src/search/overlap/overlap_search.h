#pragma once

// Finds the overlaps of bodies of worlds: a backend finds the pairs of triangles that intersect, and sums over these,
// on the host, make a row for each pair of bodies (search/overlap/overlap_row.h).
//
//   bodies  --search of worlds----------->  pairs of triangles that intersect, by pair of bodies
//           --containment/closed_bodies.h-> pairs of bodies whose boxes overlap, of closed surfaces
//   only flags are requested, and all surfaces are closed, without min_volume and self_overlaps:
//           finds which surfaces meet, then bodies inside others (containment/contained_bodies.h)
//   else for each pair of bodies, on one worker, which may share loops with others: posed vertices, sums, numbers,
//           relation, regions -> a row; depths by trees of both bodies (search/depth/); withdrawals
//           (search/withdrawal/)

#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "backends/backend.h"
#include "base/cancellation.h"
#include "crumple/overlaps.h"
#include "search/containment/closed_bodies.h"
#include "search/overlap/overlap_row.h"
#include "search/world_search.h"

namespace crumple {

class OverlapSearch {
   public:
    /// `bodies` caches the surfaces of shapes between calls.
    OverlapSearch(MemoryMeter& meter, Cancellation& cancellation, ClosedBodies& bodies);

    /// `worlds` finds the pairs of triangles that intersect, by `backend`; all else is computed by the threads and
    /// kernels of `host`, a backend that runs on the host.
    void find(BackendBase& backend, BackendBase& host, WorldSearch& worlds, const World& world,
              const OverlapQuery& query, Overlaps& result);

    /// Frees all memory, except for the surfaces.
    void release();

   private:
    /// Pair of bodies; its pairs of triangles are entries [begin, end) of `pairs_`.
    struct Candidate {
        BodyPair bodies;
        std::size_t begin, end;
    };

    std::vector<std::int32_t> list_candidates();
    bool is_one_unposed_pair() const;
    void find_pairs_of_two(BackendBase& backend);
    void find_flags(BackendBase& backend, WorldSearch& worlds, const World& world, Overlaps& result);
    void sort_pairs();
    void find_rows(BackendBase& backend, WorldSearch& worlds, const World& world, Overlaps& result);
    /// Body with its posed vertices and a tree of them.
    struct PosedTree {
        Array<Vec3d> points;
        PlacedSurface surface;
        SurfaceTree tree;

        PosedTree(const ClosedBodies& bodies, std::int32_t body, MemoryMeter* meter)
            : points(meter), surface(bodies.place(body, points)), tree(surface, meter) {}
    };
    /// Returns the tree of a body, and builds it at its first use in a call. Thread-safe.
    const SurfaceTree& tree_of(std::int32_t body);

    OverlapRow row_of(const Candidate& candidate, bool& was_exact);
    bool add_withdrawals(const PlacedSurface& a, const PlacedSurface& b, OverlapRow& row) const;
    const WorldOutline& outline() const { return bodies_.outline(); }

    MemoryMeter& meter_;
    Cancellation& cancellation_;
    ClosedBodies& bodies_;
    // State of the current call:
    BackendBase* host_ = nullptr;
    OverlapQuery query_;
    SceneBuffers buffers_of_two_;
    Intersections found_;
    Array<Pair> pairs_;  ///< pairs of triangles that may intersect, with all that do, sorted by pair of bodies
    std::vector<Candidate> candidates_;
    std::map<std::int32_t, std::pair<std::once_flag, std::unique_ptr<PosedTree>>> trees_;  ///< by body
    std::mutex trees_mutex_;
    bool none_is_open_ = true;  ///< true if all surfaces of pairs whose boxes overlap are closed
};

}  // namespace crumple
