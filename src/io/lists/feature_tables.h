#pragma once

// Tables of impacts, near pairs and candidates. All have one layout, and each list uses some of its columns.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "crumple/io_features.h"
#include "io/lists/feature_kinds.h"
#include "io/lists/list_files.h"

namespace crumple::io {

/// Names of the columns that differ between lists, and flags for the optional columns and kinds of pairs.
struct FeatureWords {
    std::string_view what;  ///< names the results in messages
    std::string_view value,
        flag;  ///< names of the columns and arrays of values and flags; empty for candidates, which have none
    bool text_has_flag;
    bool has_edge_faces, has_face_faces;  ///< the list may have pairs of these kinds

    bool has_values() const { return !value.empty(); }
    /// Returns the kinds of pairs that such a list may have: the sections of its rows.
    std::vector<CandidateKind> kinds() const;
    /// Returns the table of .txt and .csv.
    RowTable rows() const;
    /// Writes a row of such a table.
    void add(RowWriter& writer, const FeatureRow& row, bool has_bodies) const;
    /// Returns the arrays of one kind: pairs, their bodies, values and flags.
    std::vector<ListArray> arrays(CandidateKind kind) const;
};
inline constexpr FeatureWords impact_words{"impacts", "toi", "start", true, false, true};
inline constexpr FeatureWords triangle_pair_words{"pairs of triangles", "toi", "start", true, false, true};
inline constexpr FeatureWords near_words{"near pairs", "squared_distance", "touching", false, false, false};
inline constexpr FeatureWords candidate_words{"candidates", "", "", false, true, true};

const FeatureWords& words_of(ListKind kind);

/// Return the arrays of edges, which pairs name by index, and of the first edge of each body.
ListArray edges_array();
ListArray first_edge_array();

/// Return the lists of a result. Throw Error (invalid_argument) unless they fit together.
ListTable table_of(const Impacts& impacts);
ListTable table_of(const Proximities& nearby);
ListTable table_of(const Candidates& candidates);
/// Returns the list of the pairs of triangles of the impacts, without the pairs of features.
ListTable table_of_triangle_pairs(const Impacts& impacts);

/// Puts the vertex of lower index of each edge first and, if both features of the row are of one type, the lesser one
/// first (by body, then by ids).
void put_in_order(CandidateRow& row);

}  // namespace crumple::io
