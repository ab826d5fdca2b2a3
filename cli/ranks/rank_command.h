#pragma once

// What the commands that ranks share have in common.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cli/command_options.h"
#include "cli/ranks/rank_link.h"
#include "cli/ranks/ranks.h"
#include "cli/search.h"
#include "cli/steps.h"
#include "cli/threads.h"
#include "crumple/mpi.h"

namespace crumple::cli {

/// Throws Error (invalid_argument) for groups that ranks do not make, and for lists that are no lists, but coloured
/// meshes.
void check_shared_groups(const AnswerOptions& answer);
void check_shared_outputs(const std::vector<std::string>& outputs, const std::string& format);

/// Runs a command on each rank, and returns its status. Throws the Error that all ranks have; what only one rank knows
/// of ends all.
int run_on_ranks(const std::function<int(RankLink&)>& command);

/// Names the input in an Error, as Search does.
template <class Ask>
decltype(auto) about_input(const std::string& name, Ask ask) {
    try {
        return ask();
    } catch (const Error& error) {
        throw with_name(name, RankLink::as_of_one_process(error));
    }
}

/// As many threads as --threads allows, while it lives.
inline std::optional<AllowedThreads> allowed_threads(const Options& options) {
    if (!options.threads) return std::nullopt;
    return std::optional<AllowedThreads>(std::in_place, options.threads);
}

/// Has the phases of the detector's calls told as steps, which must outlive them.
void tell_phases(mpi::Detector& detector, const Steps& steps);

/// Collective. Prints the one line of --check, and returns its status.
int report_on_ranks(RankLink& link, bool any, const char* yes, const char* no);

}  // namespace crumple::cli
