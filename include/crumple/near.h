#pragma once

#include <cstdint>
#include <vector>

#include "crumple/array.h"
#include "crumple/collisions.h"
#include "crumple/features.h"
#include "crumple/world.h"

namespace crumple {

/// How much of the answer is wanted; each ends as soon as it may.
enum class NearWants : std::uint8_t {
    any,           ///< whether anything is near
    any_by_world,  ///< the same for each world
    pairs,         ///< all pairs with their distances
};

/// What is near what (docs/nearness.md). A value: it owns what it names.
struct Near {
    NearWants wants = NearWants::pairs;
    /// Features are near whose distance is at most this: Euclidean, finite, 0 or more; in the units of the coordinates.
    /// Exact as given.
    double radius = 0;
    bool strict = false;  ///< less, not equal
    bool weld = false;    ///< vertices at equal positions count as one, for neighbours
    Rules rules = {};
    bool index = false;  ///< also make the offsets of NearList, where pairs are wanted
};

/// Near pairs of one kind: unique, by first feature, then second; of worlds by body before each.
struct NearList {
    Array<Pair> pairs;               ///< indices within their bodies; see FeatureKind
    Array<BodyPair> bodies;          ///< for each pair its bodies; empty for a single mesh
    Array<double> squared_distance;  ///< exact, then rounded to the nearest number; infinite beyond the largest
    Array<std::uint8_t> touching;    ///< 1: the distance is 0 exactly

    // Where Near::index asks for them; a single mesh only:
    Array<std::int64_t> offsets;         ///< pairs of first feature i: [offsets[i], offsets[i + 1])
    Array<std::int64_t> second_offsets;  ///< the same of second features, into `by_second`
    Array<std::int64_t> by_second;       ///< positions in `pairs`, by second feature, then first
};

/// The answer. A plain value: copy it to keep it beyond the detector's next call.
struct Nearby {
    bool any = false;        ///< whether anything is near
    std::int64_t count = 0;  ///< pairs, where they are listed; else 0

    Array<std::uint8_t> world_hit;              ///< one a world: something is near (not for NearWants::any)
    std::array<NearList, feature_kinds> lists;  ///< by FeatureKind

    /// What edges are meant: as in Impacts.
    Array<Edge> edges;
    Array<std::int64_t> first_edge;

    Statistics statistics;

    NearList& operator[](FeatureKind kind) { return lists[static_cast<std::size_t>(kind)]; }
    const NearList& operator[](FeatureKind kind) const { return lists[static_cast<std::size_t>(kind)]; }
    const NearList& vertex_faces() const { return (*this)[FeatureKind::vertex_face]; }
    const NearList& edge_edges() const { return (*this)[FeatureKind::edge_edge]; }
};

}  // namespace crumple
