#pragma once

// Bodies of a world with posed vertices, and which pairs of them are wanted: what brute force about insides begins
// with.

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "crumple/query.h"
#include "crumple/world.h"
#include "scene/body_rules.h"
#include "scene/open_surface.h"
#include "scene/world_outline.h"

namespace crumple {

/// A body where it is.
struct PosedBody {
    std::vector<Vec3d> point;
    std::vector<std::array<std::int32_t, 3>> face;
    std::vector<std::int32_t> name;  ///< by vertex: the lowest vertex that it is one with
    std::set<std::int32_t> used;     ///< names of vertices at which there is an edge
    std::map<Edge, OpenEdge> open;
    Bounds box = no_bounds;

    std::array<Vec3d, 3> corners(std::size_t f) const {
        const auto at = [&](std::size_t k) { return point[static_cast<std::size_t>(face[f][k])]; };
        return {at(0), at(1), at(2)};
    }
};

class PosedBodies {
   public:
    /// `weld`: vertices of a shape at equal positions are one.
    PosedBodies(const World& world, const PairFilter& filter, bool weld, MemoryMeter& meter);

    const WorldOutline& outline() const { return outline_; }
    const PosedBody& operator[](std::int32_t b) const { return bodies_[static_cast<std::size_t>(b)]; }

    /// The wanted pairs of bodies whose boxes overlap, in order; with `self` also bodies with themselves.
    std::vector<BodyPair> near_pairs(bool self) const;
    /// The bodies of a pair whose surfaces are not closed. Throws Error (invalid_argument) for OpenSurfaces::error.
    std::vector<std::int32_t> open_bodies(const BodyPair& pair, OpenSurfaces open, const char* query) const;

   private:
    bool is_wanted(std::int32_t a, std::int32_t b, bool self) const;

    WorldOutline outline_;
    BodyRules rules_;
    std::vector<PosedBody> bodies_;
};

}  // namespace crumple
