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

/// What two features are a candidate. In a Pair `a` is the first one's index and `b` the second one's; of two features
/// of one kind a < b. The order is that of the lists in an answer.
enum class CandidateKind : std::uint8_t { vertex_face, edge_edge, edge_face, face_face, vertex_edge, vertex_vertex };
inline constexpr int candidate_kinds = 6;
constexpr std::string_view candidate_kind_name(CandidateKind kind) {
    constexpr std::array<std::string_view, candidate_kinds> names{"vertex_face", "edge_edge",   "edge_face",
                                                                  "face_face",   "vertex_edge", "vertex_vertex"};
    return names[static_cast<std::size_t>(kind)];
}

/// Which features have boxes that overlap, for those who bring their own narrow phase (docs/candidates.md). A feature's
/// box has the axes of the coordinates and holds where its vertices are at the start and, of a step, at the end; grown
/// by `inflation` on all sides. Two are a candidate if they have no vertex in common and on every axis the gap between
/// their boxes is at most twice that, in real numbers. A value: it owns what it names.
struct CandidateQuery {
    using Result = Candidates;
    using DeviceResult = DeviceCandidates;

    /// Which lists are made; at least one, the order does not matter.
    std::vector<CandidateKind> kinds{CandidateKind::vertex_face, CandidateKind::edge_edge};
    /// By how much each box is grown: finite, 0 or more; in the units of the coordinates. Exact as given.
    double inflation = 0;
    bool weld = false;  ///< vertices at equal positions at the start and at the end count as one, for "in common"
    PairFilter filter = {};
};

/// Candidates of one kind: unique, by first feature, then second; of worlds by world, then by body before each feature,
/// and pairs among bodies that are in all worlds come last.
struct CandidateList {
    Array<Pair> pairs;       ///< indices within their bodies; see CandidateKind
    Array<BodyPair> bodies;  ///< for each pair its bodies; empty for a single mesh
};

/// Result of a CandidateQuery. A plain value: copy it to keep it beyond the detector's next call.
struct Candidates {
    bool any = false;                                  ///< whether there is any candidate
    std::int64_t count = 0;                            ///< candidates of all kinds
    std::array<CandidateList, candidate_kinds> lists;  ///< by CandidateKind; empty where not asked for
    std::array<bool, candidate_kinds> listed{};        ///< by CandidateKind: whether the question named it

    /// What edges are meant: as in Impacts.
    Array<Edge> edges;
    Array<std::int64_t> first_edge;
    /// And what points.
    Array<std::int32_t> points;
    Array<std::int64_t> first_point;

    Statistics statistics;

    CandidateList& operator[](CandidateKind kind) { return lists[static_cast<std::size_t>(kind)]; }
    const CandidateList& operator[](CandidateKind kind) const { return lists[static_cast<std::size_t>(kind)]; }
};

}  // namespace crumple
