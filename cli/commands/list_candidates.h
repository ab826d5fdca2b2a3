#pragma once

// Options of crumple impacts --candidates.

#include <vector>

#include "cli/command_options.h"
#include "crumple/candidates.h"

namespace crumple::cli {

struct CandidateOptions {
    std::vector<CandidateKind> kinds;  ///< empty: those of CCD
    double inflation = 0;

    CandidateQuery query(const QueryOptions& query_options) const;
};
/// `--inflation` and `--kinds`. `with`: the option that they go with.
std::vector<const CLI::Option*> add_candidate_options(CLI::App& app, CandidateOptions& options,
                                                      const std::string& with);

}  // namespace crumple::cli
