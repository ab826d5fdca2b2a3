#pragma once

// Impacts, near pairs and candidates, as writers see them: the same lists under different names.

#include <array>
#include <span>
#include <string_view>

#include "crumple/io_features.h"
#include "io/lists/feature_kinds.h"

namespace crumple::io {

/// What a list is of.
struct FeatureWords {
    std::string_view what;         ///< for messages
    std::string_view value, flag;  ///< of columns and arrays; candidates have neither
    bool text_has_flag;
    bool has_edge_faces, has_face_faces;  ///< may have pairs of these kinds

    bool has_values() const { return !value.empty(); }
    /// Whether such a list may have pairs of this kind.
    bool has(CandidateKind kind) const {
        return kind == CandidateKind::edge_face   ? has_edge_faces
               : kind == CandidateKind::face_face ? has_face_faces
                                                  : true;
    }
};
inline constexpr FeatureWords impact_words{"impacts", "toi", "start", true, false, true};
inline constexpr FeatureWords triangle_pair_words{"pairs of triangles", "toi", "start", true, false, true};
inline constexpr FeatureWords near_words{"near pairs", "squared_distance", "touching", false, false, false};
inline constexpr FeatureWords candidate_words{"candidates", "", "", false, true, true};

struct FeatureListView {
    bool listed = false;  ///< it is to be written, be it empty
    std::span<const Pair> pairs;
    std::span<const BodyPair> bodies;
    std::span<const double> values;
    std::span<const std::uint8_t> flags;
};

struct FeatureAnswer {
    FeatureWords words;
    std::array<FeatureListView, candidate_kinds> lists;  ///< by CandidateKind
    std::span<const Edge> edges;
    std::span<const std::int64_t> first_edge;
    std::span<const std::int32_t> points;  ///< of bodies that list any; see Impacts
    std::span<const std::int64_t> first_point;
    const Statistics& statistics;
    const FirstImpact* first = nullptr;  ///< of impacts alone

    const FeatureListView& operator[](CandidateKind kind) const { return lists[static_cast<std::size_t>(kind)]; }
    /// Whether there are several.
    bool has_bodies() const { return first_edge.size() > 2; }
    bool lists_edges() const;
    FeatureRow row(CandidateKind kind, std::size_t i) const;
    /// The pair with vertices in place of points.
    Pair by_vertex(CandidateKind kind, Pair pair, const BodyPair& bodies) const;
    Pair by_vertex(CandidateKind kind, std::size_t i) const;
    BodyPair bodies_of(CandidateKind kind, std::size_t i) const;
    std::int32_t vertex(std::int32_t body, std::int32_t point) const;
};

/// Valid as long as the answer. Throws Error (invalid_argument) unless its lists fit together.
FeatureAnswer view(const Impacts& impacts);
FeatureAnswer view(const Proximities& nearby);
FeatureAnswer view(const Candidates& candidates);
/// Of pairs of triangles alone.
FeatureAnswer view_of_triangle_pairs(const Impacts& impacts);

/// use(row) in the order of the answer; of candidates value and flag say nothing.
template <class Use>
void for_each_row(const FeatureAnswer& answer, Use use) {
    for (const CandidateKind kind : all_kinds)
        for (std::size_t i = 0; i < answer[kind].pairs.size(); ++i) use(answer.row(kind, i));
}

/// The lower vertex of each edge first, and of two features of one kind the lesser.
void put_in_order(CandidateRow& row);

// Text and CSV, whose rows may come in several pieces.
class Sink;
void add_txt(Sink& sink, const FeatureAnswer& answer);
void begin_csv(Sink& sink, const FeatureWords& words);
void add_csv(Sink& sink, const FeatureAnswer& answer);

void write_features_json(std::ostream& out, const FeatureAnswer& answer);
void write_features_npz(std::ostream& out, const FeatureAnswer& answer);

}  // namespace crumple::io
