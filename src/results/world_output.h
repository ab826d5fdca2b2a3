#pragma once

// The answer for a world, as it is put together pair by pair.

#include <array>
#include <cstdint>
#include <span>

#include "crumple/function_ref.h"
#include "crumple/intersections.h"
#include "crumple/world.h"
#include "scene/world_outline.h"

namespace crumple {

/// Where an answer goes that is handed over in blocks (Detector::stream).
struct WorldBlocks {
    std::int64_t most;  ///< pairs of a block
    FunctionRef<void(const Intersections& block)> take;

    /// Hands the pairs that are there over, if they fill a block or are the last, and makes room for the next.
    void pass_on(Intersections& result, bool last = false) const;
};

/// Empty, with room for what each world gets.
void clear(Intersections& result, const WorldOutline& outline, const IntersectionQuery& question);

/// Something collides in this pass: in world `pass`, or (pass = worlds()) among the bodies that are in all worlds.
void hit(std::int32_t pass, const WorldOutline& outline, Intersections& result);

/// A colliding pair, as far as it is wanted. Pairs come in their order.
void add_pair(const WorldOutline& outline, const IntersectionQuery& question, std::int32_t pass, BodyPair bodies,
              Pair pair, Intersections& result);
/// Where the last pair meets.
void add_contact(ContactKind kind, std::span<const std::array<double, 3>> points, Intersections& result);

/// Adds pairs of bodies, in order, of which one is inside the other, to those whose surfaces meet (Output::body_pairs).
/// `finish` comes before it.
void add_contained(std::span<const BodyPair> pairs, Intersections& result);

/// What follows from the pairs: offsets and hit flags; bodies in order.
void finish(const WorldOutline& outline, const IntersectionQuery& question, Intersections& result);

}  // namespace crumple
