#pragma once

// The options that all queries have in common.

#include <cstdint>
#include <vector>

namespace crumple {

/// How much of a result is made. A query ends as soon as that is known. Which of these a query has, it says.
enum class Output : std::uint8_t {
    any,           ///< whether there is anything
    any_by_world,  ///< the same for each world
    body_pairs,    ///< which bodies: intersections only
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

/// Which pairs a query is about.
struct PairFilter {
    PairScope bodies = PairScope::both;  ///< Body::self holds as well; `both` where the scene is a mesh or two
    PairScope groups = PairScope::both;
    /// Not tested against each other, or (a body and itself) within: "allowed collision matrix" of robotics. Bodies of
    /// worlds only.
    std::vector<BodyPair> excluded_bodies = {};
    std::vector<GroupPair> excluded_groups = {};
};

}  // namespace crumple
