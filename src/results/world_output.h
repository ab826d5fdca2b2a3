#pragma once

// Assembles the result of an intersection query about a world, pair by pair.

#include <array>
#include <cstdint>
#include <span>

#include "crumple/function_ref.h"
#include "crumple/intersections.h"
#include "crumple/world.h"
#include "scene/world_outline.h"

namespace crumple {

/// Size and consumer of the blocks of a result (Detector::stream).
struct WorldBlocks {
    std::int64_t most;  ///< number of pairs per block; the last block may have fewer
    FunctionRef<void(const Intersections& block)> take;

    /// Delivers the pairs listed so far if they fill a block or are the last, then clears them.
    void deliver_if_full(Intersections& result, bool last = false) const;
};

/// Empties the result and allocates its arrays by world.
void clear(Intersections& result, const WorldOutline& outline, const IntersectionQuery& query);

/// Records a collision in world `pass` or, if `pass` is outline.worlds(), among the bodies that are in all worlds.
void hit(std::int32_t pass, const WorldOutline& outline, Intersections& result);

/// Adds a colliding pair to the arrays of the query's output. Pairs must come in order.
void add_pair(const WorldOutline& outline, const IntersectionQuery& query, std::int32_t pass, BodyPair bodies,
              Pair pair, Intersections& result);
/// Adds the contact of the last pair.
void add_contact(ContactKind kind, std::span<const std::array<double, 3>> points, Intersections& result);

/// Adds pairs of bodies of which one is inside the other to the pairs whose surfaces meet, in order, and sets `inside`.
/// `pairs` must be sorted, without pairs whose surfaces meet. For Output::body_pairs; call after finish().
void add_contained(std::span<const BodyPair> pairs, Intersections& result);

/// Completes the result. For Output::body_pairs, sorts the pairs of bodies and removes duplicates. For larger outputs,
/// makes offsets and hit flags if the query requests them (IntersectionQuery::index).
void finish(const WorldOutline& outline, const IntersectionQuery& query, Intersections& result);

}  // namespace crumple
