#pragma once

// Options that several queries have in common.

#include <cstdint>
#include <vector>

namespace crumple {

/// How much of a result is made. A query ends as soon as that is known. Which of these a query has, it says.
enum class Output : std::uint8_t {
    any,           ///< whether there is anything
    any_by_world,  ///< the same for each world
    body_pairs,    ///< which bodies: intersections and overlaps only
    count,         ///< how many pairs of triangles, in all and in each world: intersections only
    first,         ///< the first impact of each world: impacts only
    pairs,         ///< all pairs
    contacts,      ///< all pairs, and where each meets: intersections only
};

/// Two bodies by their index; the order does not matter.
struct BodyPair {
    std::int32_t first, second;
    friend auto operator<=>(const BodyPair&, const BodyPair&) = default;
};

/// Two group ids; the order does not matter.
struct GroupPair {
    std::int32_t first, second;
    friend bool operator==(const GroupPair&, const GroupPair&) = default;
};

/// Pairs across bodies or groups, pairs within one, or both. Without group ids nothing lies between groups, so that
/// `between` is an error then.
enum class PairScope : std::uint8_t { both, between, within };

/// Choice of the pairs that a query is about.
struct PairFilter {
    PairScope bodies = PairScope::both;  ///< Body::self holds as well; `both` where the scene is a mesh or two
    PairScope groups = PairScope::both;
    /// Not tested against each other, or (a body and itself) within: "allowed collision matrix" of robotics. Bodies of
    /// worlds only.
    std::vector<BodyPair> excluded_bodies = {};
    std::vector<GroupPair> excluded_groups = {};
};

/// Treatment of a body whose surface is not closed, where its winding numbers are needed. A surface is closed if each
/// edge occurs in its triangles equally often in both directions.
enum class OpenSurfaces : std::uint8_t {
    error,  ///< Error (invalid_argument) that names the body, an open edge and a triangle at it
    skip,   ///< the body has no inside, and `skipped` of the result names it; overlaps have no rows for its pairs
    /// Overlap queries only: pairs whose surfaces meet have a row with the relation `undefined`, NaN for all numbers
    /// but the contact area and the torque point, and curves if they are requested.
    curves,
};

}  // namespace crumple
