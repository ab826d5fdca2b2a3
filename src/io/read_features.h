#pragma once

// What the readers of impacts and of near pairs have in common.

#include <optional>
#include <string>
#include <vector>

#include "io/feature_answer.h"
#include "io/source.h"

namespace crumple::io {

/// Rows as they come.
class FeatureRows {
   public:
    explicit FeatureRows(const FeatureWords& words) : words_(words) {}

    const FeatureWords& words() const { return words_; }
    /// Puts the row's edges in order and appends it. Says what is wrong with it; empty: nothing.
    std::string add(FeatureRow row, bool has_bodies);
    FeatureList take() { return std::move(list_); }

   private:
    FeatureWords words_;
    FeatureList list_;
};

/// Which arrays the readers of .json and .npz look for, and how many numbers a row of each has.
struct ArrayName {
    std::string name;
    std::size_t columns;
};
std::vector<ArrayName> arrays_of(const FeatureWords& words);

/// Numbers by row of the arrays that a file has, in the order of `arrays_of`: 32-bit integers and smaller are exact.
using NumberArrays = std::vector<std::optional<std::vector<double>>>;
FeatureList list_from(const Source& source, const FeatureWords& words, const NumberArrays& arrays);

FeatureList read_features_json(const Source& source, const FeatureWords& words);
FeatureList read_features_npz(const Source& source, const FeatureWords& words);

}  // namespace crumple::io
