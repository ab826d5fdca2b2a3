#pragma once

// Options shared by several queries.

#include <cstdint>
#include <vector>

namespace crumple {

/// How much of a result is made, from least to most. The search ends as soon as the output is decided. Each query
/// documents which values it takes.
enum class Output : std::uint8_t {
    any,           ///< one flag: there is a result
    any_by_world,  ///< one flag per world
    body_pairs,    ///< pairs of bodies: intersections and overlaps only
    count,         ///< number of pairs of triangles, in total and per world: intersections only
    first,         ///< the first impact of each world: impacts only
    nearest,       ///< the nearest pair of bodies of each world: distances only
    pairs,         ///< all pairs
    contacts,      ///< all pairs, and the points where each meets: intersections only
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

/// Selects pairs between two different bodies or groups, pairs within one body or group, or both. `between` for groups
/// is an error if there are no group ids.
enum class PairScope : std::uint8_t { both, between, within };

/// Pair filter of a query.
struct PairFilter {
    PairScope bodies = PairScope::both;  ///< Body::self applies as well; must be `both` for one or two meshes
    PairScope groups = PairScope::both;
    /// Pairs of bodies to skip, the "allowed collision matrix" of robotics; a body with itself skips the pairs within
    /// that body. Worlds only.
    std::vector<BodyPair> excluded_bodies = {};
    /// Pairs of groups to skip; a group with itself skips the pairs within that group.
    std::vector<GroupPair> excluded_groups = {};
};

/// Treatment of a body whose surface is not closed, where its winding numbers are needed. A surface is closed if each
/// edge occurs in its triangles equally often in both directions.
enum class OpenSurfaces : std::uint8_t {
    error,  ///< throws Error (invalid_argument) that names the body, an open edge and a triangle with it
    skip,   ///< the body has no inside, and `skipped` of the result names it; overlaps have no rows for its pairs
    /// Overlap queries only: pairs whose surfaces meet have a row with the relation `undefined`, NaN for all numbers
    /// but the contact area and the torque point, and curves if they are requested.
    curves,
};

}  // namespace crumple
