#pragma once

// Options of crumple impacts --candidates.

#include <vector>

#include "cli/command_options.h"
#include "crumple/candidates.h"

namespace crumple::cli {

struct CandidateOptions {
    std::vector<CandidateKind> kinds;  ///< kinds to list; empty: vertex_face and edge_edge
    double inflation = 0;
    bool neighbours = false;  ///< also lists pairs with a common vertex

    CandidateQuery query(const QueryOptions& query_options) const;
};
/// Adds `--inflation`, `--kinds` and `--with-neighbours`, and returns them. `with`: the option that they require, for
/// their help.
std::vector<const CLI::Option*> add_candidate_options(CLI::App& app, CandidateOptions& options,
                                                      const std::string& with);

}  // namespace crumple::cli
