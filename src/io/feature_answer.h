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
    const Statistics& statistics;
    const FirstImpact* first = nullptr;  ///< of near pairs there is none

    /// Whether there are several.
    bool has_bodies() const { return first_edge.size() > 2; }
    FeatureRow row(FeatureKind kind, std::size_t i) const;
};

/// Valid as long as the answer. Throws Error (invalid_argument) unless its lists fit together.
FeatureAnswer view(const Impacts& impacts);
FeatureAnswer view(const Nearby& nearby);

inline constexpr std::array<FeatureKind, feature_kinds> all_feature_kinds{FeatureKind::vertex_face,
                                                                          FeatureKind::edge_edge};

/// "vertex_faces", "vertex_face_toi": the arrays of one kind.
inline std::string array_of(FeatureKind kind) { return std::string(feature_kind_name(kind)) + 's'; }
inline std::string array_of(FeatureKind kind, std::string_view what) {
    return std::string(feature_kind_name(kind)) + '_' + std::string(what);
}

/// How a list of text names the kind.
inline std::string_view short_name(FeatureKind kind) { return kind == FeatureKind::vertex_face ? "vf" : "ee"; }
/// Ids of a row.
inline std::size_t id_count(FeatureKind kind) { return kind == FeatureKind::vertex_face ? 2 : 4; }

void write_features_json(std::ostream& out, const FeatureAnswer& answer);
void write_features_npz(std::ostream& out, const FeatureAnswer& answer);

}  // namespace crumple::io
