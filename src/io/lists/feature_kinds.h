#pragma once

// Kinds of feature pairs (a feature is a vertex, an edge or a face) and their names in files. CandidateKind includes
// all kinds of impacts and near pairs, in the same order.

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

/// Type of a feature. In rows of .txt and .csv an edge has two ids, those of its vertices. In arrays of .json and .npz
/// it has one, its index.
enum class Feature : std::uint8_t { vertex, edge, face };

/// Names and columns of one kind.
struct KindInFiles {
    std::string_view keyword;            ///< first word of the rows of this kind in .txt and .csv
    std::string_view array;              ///< name of the array of pairs in .json and .npz
    std::array<Feature, 2> features;     ///< types of the two features
    std::array<std::size_t, 4> columns;  ///< columns of a row's ids in a .csv of kind,vertex,face,a,b,c,d
};
inline const KindInFiles& in_files(CandidateKind kind) {
    constexpr auto vertex = Feature::vertex, edge = Feature::edge, face = Feature::face;
    static constexpr std::array<KindInFiles, candidate_kinds> kinds{{
        {"vf", "vertex_faces", {vertex, face}, {1, 2}},
        {"ee", "edge_edges", {edge, edge}, {3, 4, 5, 6}},
        {"ef", "edge_faces", {edge, face}, {3, 4, 2}},
        {"ff", "face_faces", {face, face}, {2, 3}},
        {"ve", "vertex_edges", {vertex, edge}, {1, 3, 4}},
        {"vv", "vertex_vertices", {vertex, vertex}, {1, 3}},
    }};
    return kinds[static_cast<std::size_t>(kind)];
}

/// Returns the type of the first (`side` 0) or second (`side` 1) feature of a pair.
inline Feature feature_of(CandidateKind kind, std::size_t side) { return in_files(kind).features[side]; }
inline bool is_edge(CandidateKind kind, std::size_t side) { return feature_of(kind, side) == Feature::edge; }
/// Return the number of ids of the first feature, and of a whole row.
inline std::size_t first_ids(CandidateKind kind) { return is_edge(kind, 0) ? 2 : 1; }
inline std::size_t id_count(CandidateKind kind) { return first_ids(kind) + (is_edge(kind, 1) ? 2 : 1); }

}  // namespace crumple::io
