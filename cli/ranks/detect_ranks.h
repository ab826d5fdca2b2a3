#pragma once

// crumple detect on several processes of MPI: one mesh, of which each reads, searches and writes its part.

#include <string>
#include <vector>

#include "cli/command_options.h"

namespace crumple::cli {

struct RanksDetection {
    const std::vector<std::string>&files, &outputs;
    const std::string& format;
    const AnswerOptions& answer;
    const Options& options;
    bool check, stats, stream, progress;
};

/// Called by all ranks (ranks.h), returns the same status on all. Throws Error, the same on all ranks: invalid_argument
/// for what is not shared among ranks, else as the search of one process does.
int detect_on_ranks(const RanksDetection& detection);

}  // namespace crumple::cli
