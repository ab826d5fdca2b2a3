#pragma once

// What the readers of impacts, of near pairs and of candidates have in common.

#include <optional>
#include <string>
#include <vector>

#include "io/bytes/source.h"
#include "io/lists/feature_list_view.h"

namespace crumple::io {

/// Rows as they come, into a list.
class FeatureRows {
   public:
    FeatureRows(const FeatureWords& words, FeatureList& list) : words_(words), features_(&list) {}
    explicit FeatureRows(CandidateRows& list) : words_(candidate_words), candidates_(&list) {}

    const FeatureWords& words() const { return words_; }
    /// Puts the row's edges in order and appends it. Says what is wrong with it; empty: nothing.
    std::string add(FeatureRow row, bool has_bodies);

   private:
    FeatureWords words_;
    FeatureList* features_ = nullptr;  ///< or
    CandidateRows* candidates_ = nullptr;
    std::optional<bool> has_bodies_;
};

/// Which arrays the readers of .json and .npz look for, and how many numbers a row of each has.
struct ArrayName {
    std::string name;
    std::size_t columns;
    bool wanted;  ///< else it is of another list, whatever the file has by that name
};
std::vector<ArrayName> arrays_of(const FeatureWords& words);

/// Numbers by row of the arrays that a file has, in the order of `arrays_of`: 32-bit integers and smaller are exact.
using NumberArrays = std::vector<std::optional<std::vector<double>>>;
void add_rows(const Source& source, const NumberArrays& arrays, FeatureRows& rows);

void read_features_json(const Source& source, FeatureRows& rows);
void read_features_npz(const Source& source, FeatureRows& rows);

}  // namespace crumple::io
