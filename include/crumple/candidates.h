#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "crumple/array.h"
#include "crumple/features.h"
#include "crumple/intersections.h"
#include "crumple/world.h"

namespace crumple {

struct Candidates;
struct DeviceCandidates;

/// Kind of a candidate pair. In a Pair of features, `a` is the index of the feature that the kind names first, `b` of
/// the other one; a < b for two edges, faces or vertices. Results hold their lists in the order of this enum.
enum class CandidateKind : std::uint8_t { vertex_face, edge_edge, edge_face, face_face, vertex_edge, vertex_vertex };
inline constexpr int candidate_kinds = 6;
/// Returns the name of the enumerator, such as "vertex_face".
constexpr std::string_view candidate_kind_name(CandidateKind kind) {
    constexpr std::array<std::string_view, candidate_kinds> names{"vertex_face", "edge_edge",   "edge_face",
                                                                  "face_face",   "vertex_edge", "vertex_vertex"};
    return names[static_cast<std::size_t>(kind)];
}

/// Query for all pairs of features whose inflated boxes overlap: the broad phase for a narrow phase of the caller
/// (docs/candidates.md). The box of a feature is axis-aligned, contains its vertices at the start and, if they move, at
/// the end, and is inflated by `inflation` on all sides. Two features are a candidate pair if they have no common
/// vertex (unless `neighbours` is set) and the gap between their original boxes is at most twice the inflation on every
/// axis, in real numbers. A value: it owns its data.
struct CandidateQuery {
    using Result = Candidates;
    using DeviceResult = DeviceCandidates;

    /// Kinds to list: at least one, in any order.
    std::vector<CandidateKind> kinds{CandidateKind::vertex_face, CandidateKind::edge_edge};
    /// Distance by which each box is widened on all sides: finite, 0 or more; in the units of the coordinates. Not
    /// rounded.
    double inflation = 0;
    bool weld = false;  ///< vertices with equal positions at start and end count as one common vertex
    /// Also lists pairs with a common vertex, such as an edge and a face that contains it, but no feature with itself.
    /// Not supported by the cuda backend.
    bool neighbours = false;
    PairFilter filter = {};
};

/// Candidates of one kind, each once, sorted by first feature, then second. For worlds sorted by world, first body,
/// first feature, second body, second feature; pairs among bodies that are in all worlds come last.
struct CandidateList {
    Array<Pair> pairs;       ///< indices within their bodies; see CandidateKind
    Array<BodyPair> bodies;  ///< the bodies of each pair; empty for a single mesh
};

/// Result of a CandidateQuery. A plain value: copy it to keep it beyond the detector's next call.
struct Candidates {
    bool any = false;                                  ///< true if there is any candidate
    std::int64_t count = 0;                            ///< number of candidates of all kinds
    std::array<CandidateList, candidate_kinds> lists;  ///< by CandidateKind; empty if not requested
    std::array<bool, candidate_kinds> listed{};        ///< by CandidateKind: true if requested

    /// The edges that indices refer to: as in Impacts.
    Array<Edge> edges;
    Array<std::int64_t> first_edge;
    /// The points that indices refer to: as in Impacts.
    Array<std::int32_t> points;
    Array<std::int64_t> first_point;

    Statistics statistics;

    CandidateList& operator[](CandidateKind kind) { return lists[static_cast<std::size_t>(kind)]; }
    const CandidateList& operator[](CandidateKind kind) const { return lists[static_cast<std::size_t>(kind)]; }
};

}  // namespace crumple
