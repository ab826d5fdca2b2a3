#pragma once

// crumple verify --impacts, --candidates, and --radius or --radii: checks a list of impacts, candidates or near pairs.

#include <string>
#include <vector>

#include "cli/commands/list_candidates.h"
#include "cli/near_filters.h"
#include "cli/search_command.h"

namespace crumple::cli {

struct FeatureCheck {
    bool impacts = false, candidates = false;
    MotionOptions motion;
    CandidateOptions candidate_options;
    NearOptions near;
    NearFilterOptions filters;
    std::vector<const CLI::Option*> of_candidates;  ///< options that need --candidates
    std::vector<const CLI::Option*> of_near;        ///< options that need --radius or --radii

    bool near_pairs() const { return near.radius || !filters.radii.empty(); }
    bool any() const { return impacts || candidates || near_pairs(); }
    /// True if the options request a check of a list of impacts, candidates or near pairs. Throws Error
    /// (invalid_argument) if options conflict.
    bool is_requested(const QueryOptions& query_options) const;
};
void add_feature_check_options(CLI::App& app, FeatureCheck& check);

/// Checks the list, which is the last of `files`. Prints what is wrong with it and returns the exit status.
int verify_features(const FeatureCheck& check, const std::vector<std::string>& files, const std::string& format,
                    const QueryOptions& query_options, const Options& options);

}  // namespace crumple::cli
