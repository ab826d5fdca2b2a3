#pragma once

// crumple verify --overlaps: checks a list of overlaps.

#include <string>
#include <vector>

#include "cli/bodies/found_overlaps.h"
#include "cli/commands/verify_features.h"

namespace crumple::cli {

struct OverlapCheck {
    bool overlaps = false;
    OverlapOptions options;
    std::vector<const CLI::Option*> of_overlaps;  ///< options that need --overlaps

    /// True if the options request a check of a list of overlaps. Throws Error (invalid_argument) if options conflict.
    bool is_requested(const FeatureCheck& features, const QueryOptions& query_options) const;
};
void add_overlap_check_options(CLI::App& app, OverlapCheck& check);

/// Checks the list, which is the last of `files`. Prints what is wrong with it and returns the exit status.
int verify_overlaps(const OverlapCheck& check, const std::vector<std::string>& files, const std::string& format,
                    const QueryOptions& query_options, const Options& options);

}  // namespace crumple::cli
