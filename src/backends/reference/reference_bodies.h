#pragma once

// Bodies of a world with their poses applied, and the pairs of bodies that the pair filter keeps: input of brute force
// for overlaps and containment.

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "crumple/query.h"
#include "crumple/world.h"
#include "scene/body_filter.h"
#include "scene/open_surface.h"
#include "scene/world_outline.h"

namespace crumple {

/// Body with posed vertices.
struct PosedBody {
    std::vector<Vec3d> point;
    std::vector<std::array<std::int32_t, 3>> face;
    std::vector<std::int32_t> name;  ///< by vertex: its representative vertex, the lowest that it is merged with
    std::set<std::int32_t> used;     ///< representatives of vertices that have an edge
    std::map<Edge, OpenEdge> open;   ///< edges that faces traverse more often in one direction than in the other
    Bounds box = no_bounds;

    std::array<Vec3d, 3> corners(std::size_t f) const {
        const auto at = [&](std::size_t k) { return point[static_cast<std::size_t>(face[f][k])]; };
        return {at(0), at(1), at(2)};
    }
};

class PosedBodies {
   public:
    /// Applies the poses. `weld`: merges vertices of a shape at equal positions.
    PosedBodies(const World& world, const PairFilter& filter, bool weld, MemoryMeter& meter);

    const WorldOutline& outline() const { return outline_; }
    const PosedBody& operator[](std::int32_t b) const { return bodies_[static_cast<std::size_t>(b)]; }

    /// Returns the pairs of bodies that the filter keeps and whose boxes overlap, in order; with `self` also bodies
    /// with themselves.
    std::vector<BodyPair> near_pairs(bool self) const;
    /// Returns the bodies of a pair whose surfaces are not closed. Throws Error (invalid_argument) for
    /// OpenSurfaces::error. `query`: type of the query, for the message.
    std::vector<std::int32_t> open_bodies(const BodyPair& pair, OpenSurfaces open, const char* query) const;

   private:
    bool is_selected(std::int32_t a, std::int32_t b, bool self) const;

    WorldOutline outline_;
    BodyFilter body_filter_;
    std::vector<PosedBody> bodies_;
};

}  // namespace crumple
