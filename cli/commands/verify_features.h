#pragma once

// crumple verify --impacts, --candidates and --radius: checks a list of impacts, candidates or near pairs.

#include <string>
#include <vector>

#include "cli/commands/list_candidates.h"
#include "cli/search_command.h"

namespace crumple::cli {

struct FeatureCheck {
    bool impacts = false, candidates = false;
    MotionOptions motion;
    CandidateOptions candidate_options;
    NearOptions near;
    std::vector<const CLI::Option*> of_candidates;  ///< options that need --candidates

    bool any() const { return impacts || candidates || near.radius; }
    /// True if the options request a check of a list of impacts, candidates or near pairs. Throws Error
    /// (invalid_argument) if options conflict.
    bool is_requested(const QueryOptions& query_options) const;
};
void add_feature_check_options(CLI::App& app, FeatureCheck& check);

/// Checks the list, which is the last of `files`. Prints what is wrong with it and returns the exit status.
int verify_features(const FeatureCheck& check, const std::vector<std::string>& files, const std::string& format,
                    const QueryOptions& query_options, const Options& options);

}  // namespace crumple::cli
