#pragma once

// Finds the overlaps of bodies of worlds, on any backend that runs on the host: the backend finds the pairs of
// triangles that intersect, and each pair of bodies becomes a row by sums over these (search/overlap_row.h).
//
//   shapes  -----------------------------> surfaces: closed?, and the order of their vertices; kept between calls
//   bodies  --worlds, by the backend----->  pairs of triangles, by pair of bodies
//           --boxes that overlap--------->  pairs of bodies that may hold one another
//   each pair of bodies, on one worker: posed vertices, sums, numbers, relation -> a row

#include <memory>
#include <vector>

#include "backends/backend.h"
#include "base/cancellation.h"
#include "crumple/overlaps.h"
#include "scene/body_rules.h"
#include "scene/closed_surface.h"
#include "scene/near_bodies.h"
#include "scene/orientation.h"
#include "scene/world_outline.h"
#include "search/overlap_row.h"
#include "search/world_search.h"

namespace crumple {

class OverlapSearch {
   public:
    OverlapSearch(MemoryMeter& meter, Cancellation& cancellation);

    /// `worlds` finds the pairs of triangles.
    void find(BackendBase& backend, WorldSearch& worlds, const World& world, const OverlapQuery& query,
              Overlaps& result);

    /// Gives all memory back.
    void release();

   private:
    /// A pair of bodies, and its pairs of triangles: those of `pairs_` from `begin` to `end`.
    struct Candidate {
        BodyPair bodies;
        std::size_t begin, end;
    };
    struct Surface {
        explicit Surface(MemoryMeter* m) : closed(m) {}
        ClosedSurface closed;
        CentredBox box;
        bool empty = true;
    };

    void read_surfaces(BackendBase& backend);
    std::vector<std::int32_t> list_candidates();
    bool is_one_pair_at_rest() const;
    void find_pairs_of_two(BackendBase& backend);
    void take_flags(Overlaps& result);
    void sort_pairs();
    void find_rows(BackendBase& backend, Overlaps& result);
    Bounds box_of_vertices(std::int32_t body) const;
    void check_closed(std::int32_t body) const;
    /// Returns −1 if the pose of a body turns it inside out: its faces are meant to be reversed then.
    int orientation(std::int32_t body) const { return orientation_of(outline_.placement(body)) < 0 ? -1 : 1; }
    PlacedSurface place(std::int32_t body, std::vector<Vec3d>& points) const;
    OverlapRow row_of(BackendBase& backend, const Candidate& candidate, bool& was_exact) const;
    const Surface& surface(std::int32_t body) const {
        return *surfaces_[static_cast<std::size_t>(outline_.body(body).shape)];
    }

    MemoryMeter& meter_;
    Cancellation& cancellation_;
    // State of the current call:
    OverlapQuery query_;
    WorldOutline outline_;
    BodyRules rules_;
    NearBodies near_;
    SceneBuffers buffers_, buffers_of_two_;
    std::vector<std::unique_ptr<Surface>> surfaces_;  ///< by shape; kept
    Intersections found_;
    Array<Pair> pairs_;  ///< by pair of bodies
    std::vector<Candidate> candidates_;
    bool none_is_open_ = true;  ///< all pairs of bodies whose boxes overlap are candidates
};

}  // namespace crumple
