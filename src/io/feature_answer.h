#pragma once

// Impacts and near pairs, as writers see them: the same lists under different names.

#include <array>
#include <span>
#include <string>
#include <string_view>

#include "crumple/io_features.h"

namespace crumple::io {

/// What a list is of.
struct FeatureWords {
    std::string_view what;         ///< for messages
    std::string_view value, flag;  ///< of columns and arrays
    bool text_has_flag;
};
inline constexpr FeatureWords impact_words{"impacts", "toi", "start", true};
inline constexpr FeatureWords near_words{"near pairs", "squared_distance", "touching", false};

struct FeatureListView {
    std::span<const Pair> pairs;
    std::span<const BodyPair> bodies;
    std::span<const double> values;
    std::span<const std::uint8_t> flags;
};

struct FeatureAnswer {
    FeatureWords words;
    std::array<FeatureListView, feature_kinds> lists;
    std::span<const Edge> edges;
    std::span<const std::int64_t> first_edge;
    std::span<const std::int32_t> points;  ///< of bodies that list any; see Impacts
    std::span<const std::int64_t> first_point;
    const Statistics& statistics;
    const FirstImpact* first = nullptr;  ///< of near pairs there is none

    /// Whether there are several.
    bool has_bodies() const { return first_edge.size() > 2; }
    FeatureRow row(FeatureKind kind, std::size_t i) const;
    /// The pair with vertices in place of points.
    Pair by_vertex(FeatureKind kind, Pair pair, const BodyPair& bodies) const;
    Pair by_vertex(FeatureKind kind, std::size_t i) const;
    BodyPair bodies_of(FeatureKind kind, std::size_t i) const;
    std::int32_t vertex(std::int32_t body, std::int32_t point) const;
};

/// Valid as long as the answer. Throws Error (invalid_argument) unless its lists fit together.
FeatureAnswer view(const Impacts& impacts);
FeatureAnswer view(const Nearby& nearby);

inline constexpr std::array<FeatureKind, feature_kinds> all_feature_kinds{
    FeatureKind::vertex_face, FeatureKind::edge_edge, FeatureKind::vertex_edge, FeatureKind::vertex_vertex};

/// "vertex_faces", "vertex_face_toi": the arrays of one kind.
inline std::string array_of(FeatureKind kind) {
    return kind == FeatureKind::vertex_vertex ? "vertex_vertices" : std::string(feature_kind_name(kind)) + 's';
}
inline std::string array_of(FeatureKind kind, std::string_view what) {
    return std::string(feature_kind_name(kind)) + '_' + std::string(what);
}

/// How a list of text names the kind.
inline std::string_view short_name(FeatureKind kind) {
    constexpr std::array<std::string_view, feature_kinds> names{"vf", "ee", "ve", "vv"};
    return names[static_cast<std::size_t>(kind)];
}
/// Whether a feature of the pair is an edge, which has two ids; `side`: 0 or 1.
inline bool is_edge(FeatureKind kind, std::size_t side) {
    return kind == FeatureKind::edge_edge || (kind == FeatureKind::vertex_edge && side == 1);
}
/// Ids of the first feature, and of a row.
inline std::size_t first_ids(FeatureKind kind) { return is_edge(kind, 0) ? 2 : 1; }
inline std::size_t id_count(FeatureKind kind) { return first_ids(kind) + (is_edge(kind, 1) ? 2 : 1); }
/// Which of the columns vertex, face, a, b, c, d of a .csv the ids are in.
inline constexpr std::size_t most_id_columns = 6;
inline std::span<const std::size_t> id_columns(FeatureKind kind) {
    static constexpr std::array<std::size_t, 4> edges{2, 3, 4, 5};
    static constexpr std::array<std::size_t, 2> face{0, 1}, vertices{0, 2};
    static constexpr std::array<std::size_t, 3> edge{0, 2, 3};
    if (kind == FeatureKind::vertex_face) return face;
    if (kind == FeatureKind::edge_edge) return edges;
    if (kind == FeatureKind::vertex_edge) return edge;
    return vertices;
}
/// The lower vertex of each edge first, and of two edges or two vertices the lesser.
void put_in_order(FeatureRow& row);

void write_features_json(std::ostream& out, const FeatureAnswer& answer);
void write_features_npz(std::ostream& out, const FeatureAnswer& answer);

}  // namespace crumple::io
