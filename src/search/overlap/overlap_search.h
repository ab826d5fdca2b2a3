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
//
// A result in blocks is made slice by slice (slice_of_world.h), so that neither all rows nor all pairs of triangles are
// in memory at once.

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "backends/backend.h"
#include "base/cancellation.h"
#include "crumple/overlaps.h"
#include "results/overlap_rows.h"
#include "search/containment/closed_bodies.h"
#include "search/overlap/overlap_batch.h"
#include "search/overlap/overlap_row.h"
#include "search/overlap/pairs_of_parts.h"
#include "search/world_search.h"

namespace crumple {

class OverlapSearch {
   public:
    /// `bodies` caches the surfaces of shapes between calls.
    OverlapSearch(MemoryMeter& meter, Cancellation& cancellation, ClosedBodies& bodies);

    /// `worlds` finds the pairs of triangles that intersect, by `backend`; all else is computed by the threads and
    /// kernels of `host`, a backend that runs on the host. If `blocks` is not null, delivers the rows in blocks: the
    /// same rows, in the same order, without `world_hit`. A result without rows that has lists by body, or skipped
    /// bodies, is one block without rows. If `parts` is not null, nothing is searched: it has the pairs of triangles.
    void find(BackendBase& backend, BackendBase& host, WorldSearch& worlds, const World& world,
              const OverlapQuery& query, Overlaps& result, const OverlapBlocks* blocks = nullptr,
              const PairsOfParts* parts = nullptr);

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
    using Candidates = std::span<Candidate>;
    /// Finds the pairs of triangles of some candidates.
    void find_pairs(BackendBase& backend, WorldSearch& worlds, const World& world, Candidates candidates,
                    Statistics& statistics);
    void sort_pairs(Candidates candidates);
    std::unique_ptr<OverlapBatch> cross_on_device(Candidates candidates);
    void read_pairs(Candidates candidates);
    std::vector<OverlapRow> make_rows(Candidates candidates, MemoryClaim& memory);
    void find_rows(BackendBase& backend, WorldSearch& worlds, const World& world, Overlaps& result);
    void add_if_in_result(const Candidate& candidate, const OverlapRow& row, bool solids, Overlaps& result) const;
    // Results in blocks:
    template <class Each>
    void for_each_slice(BackendBase& backend, WorldSearch& worlds, const World& world, Each each,
                        Statistics& statistics);
    std::size_t end_of_slice(std::size_t begin) const;
    void find_bodies(BackendBase& backend, WorldSearch& worlds, const World& world, Overlaps& result);
    void stream_rows(BackendBase& backend, WorldSearch& worlds, const World& world, Overlaps& result);
    void deliver(Overlaps& result);
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
    OverlapRow row_of(const BodyPair& bodies, const PlacedSurface& a, const PlacedSurface& b,
                      std::span<const Pair> pairs, const RowOnDevice& on_device, bool& was_exact);
    std::span<const Pair> pairs_of(const Candidate& candidate) const {
        return {pairs_.data() + candidate.begin, candidate.end - candidate.begin};
    }
    bool add_withdrawals(const PlacedSurface& a, const PlacedSurface& b, OverlapRow& row) const;
    const WorldOutline& outline() const { return bodies_.outline(); }

    MemoryMeter& meter_;
    Cancellation& cancellation_;
    ClosedBodies& bodies_;
    // State of the current call:
    BackendBase* host_ = nullptr;
    OverlapDevice* device_ = nullptr;  ///< null if the backend has none
    OverlapQuery query_;
    const OverlapBlocks* blocks_ = nullptr;
    const PairsOfParts* parts_ = nullptr;
    std::int64_t delivered_ = 0;             ///< number of rows delivered in blocks
    std::atomic<std::int64_t> rational_{0};  ///< number of rows that needed rational arithmetic
    SceneBuffers buffers_of_two_;
    Intersections found_;
    Array<Pair> pairs_;           ///< pairs of triangles that may intersect, with all that do, sorted by pair of bodies
    std::vector<BodyPair> near_;  ///< selected pairs of bodies whose boxes overlap, sorted
    std::vector<Candidate> candidates_;
    std::map<std::int32_t, std::pair<std::once_flag, std::unique_ptr<PosedTree>>> trees_;  ///< by body
    std::mutex trees_mutex_;
    bool none_is_open_ = true;  ///< true if all surfaces of pairs whose boxes overlap are closed
};

}  // namespace crumple
