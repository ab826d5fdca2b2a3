#pragma once

// Kinds of pairs of features as files name them: those of candidates, which hold those of impacts and near pairs in the
// same order.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "crumple/candidates.h"
#include "crumple/features.h"

namespace crumple::io {

inline constexpr std::array<CandidateKind, candidate_kinds> all_kinds{
    CandidateKind::vertex_face, CandidateKind::edge_edge,   CandidateKind::edge_face,
    CandidateKind::face_face,   CandidateKind::vertex_edge, CandidateKind::vertex_vertex};

inline constexpr std::array<FeatureKind, feature_kinds> all_feature_kinds{
    FeatureKind::vertex_face, FeatureKind::edge_edge, FeatureKind::vertex_edge, FeatureKind::vertex_vertex};

constexpr CandidateKind kind_of(FeatureKind kind) {
    constexpr std::array<CandidateKind, feature_kinds> kinds{CandidateKind::vertex_face, CandidateKind::edge_edge,
                                                             CandidateKind::vertex_edge, CandidateKind::vertex_vertex};
    return kinds[static_cast<std::size_t>(kind)];
}

/// "vertex_faces", "vertex_face_toi": the arrays of one kind.
inline std::string array_of(CandidateKind kind) {
    return kind == CandidateKind::vertex_vertex ? "vertex_vertices" : std::string(candidate_kind_name(kind)) + 's';
}
inline std::string array_of(CandidateKind kind, std::string_view what) {
    return std::string(candidate_kind_name(kind)) + '_' + std::string(what);
}

/// How a list of text names the kind.
inline std::string_view short_name(CandidateKind kind) {
    constexpr std::array<std::string_view, candidate_kinds> names{"vf", "ee", "ef", "ff", "ve", "vv"};
    return names[static_cast<std::size_t>(kind)];
}

/// What a feature of the pair is; `side`: 0 or 1. An edge has two ids.
enum class Feature : std::uint8_t { vertex, edge, face };
inline Feature feature_of(CandidateKind kind, std::size_t side) {
    constexpr auto vertex = Feature::vertex, edge = Feature::edge, face = Feature::face;
    constexpr Feature features[candidate_kinds][2] = {{vertex, face}, {edge, edge},   {edge, face},
                                                      {face, face},   {vertex, edge}, {vertex, vertex}};
    return features[static_cast<std::size_t>(kind)][side];
}
inline bool is_edge(CandidateKind kind, std::size_t side) { return feature_of(kind, side) == Feature::edge; }
/// Ids of the first feature, and of a row.
inline std::size_t first_ids(CandidateKind kind) { return is_edge(kind, 0) ? 2 : 1; }
inline std::size_t id_count(CandidateKind kind) { return first_ids(kind) + (is_edge(kind, 1) ? 2 : 1); }

/// Columns of a .csv with ids: vertex, face, a, b, c, d.
inline constexpr std::size_t most_id_columns = 6;
/// The column of each id of a row.
inline std::span<const std::size_t> id_columns(CandidateKind kind) {
    static constexpr std::array<std::size_t, 4> edge_edge{2, 3, 4, 5};
    static constexpr std::array<std::size_t, 3> edge_face{2, 3, 1}, vertex_edge{0, 2, 3};
    static constexpr std::array<std::size_t, 2> vertex_face{0, 1}, face_face{1, 2}, vertex_vertex{0, 2};
    const std::span<const std::size_t> columns[candidate_kinds] = {vertex_face, edge_edge,   edge_face,
                                                                   face_face,   vertex_edge, vertex_vertex};
    return columns[static_cast<std::size_t>(kind)];
}

}  // namespace crumple::io
