#pragma once

// Searches that processes of MPI share: of one mesh, of which each reads, searches and writes its part.

#include <string>
#include <vector>

#include "cli/search_command.h"
namespace crumple::cli {

/// Does what a command does once its options are read. Called by all ranks (ranks.h), returns the same status on all.
/// `files`: of a mesh, or of its start and end. A query of intersections, impacts or proximities; with Output::first
/// only the first impact is listed. Throws Error, the same on all ranks: invalid_argument for what is not shared among
/// ranks, else as the search of one process does.
template <class Query>
int search_on_ranks(const SearchCommand& command, const std::vector<std::string>& files, const Query& query);

}  // namespace crumple::cli
