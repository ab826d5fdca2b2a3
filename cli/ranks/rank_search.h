#pragma once

// Searches shared by MPI processes, each of which reads, searches and writes its part of one mesh.

#include <string>
#include <vector>

#include "cli/search_command.h"
namespace crumple::cli {

/// Runs a command whose options have been parsed. Collective (ranks.h); returns the same status on all ranks. `files`:
/// a mesh, or its start and end. `query`: about intersections, impacts or proximities; with Output::first only the
/// first impact is listed. Throws the same Error on all ranks: invalid_argument for what is not supported on ranks,
/// else as the search of a single process does.
template <class Query>
int search_on_ranks(const SearchCommand& command, const std::vector<std::string>& files, const Query& query);

}  // namespace crumple::cli
