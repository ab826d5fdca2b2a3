#pragma once

// Searches shared by MPI processes, each of which reads, searches and writes its part of one mesh.

#include <string>
#include <vector>

#include "cli/search_command.h"
namespace crumple::cli {

/// Collective. Runs a command whose options have been parsed, and returns the same exit status on all ranks. `files`: a
/// mesh, or a mesh at the start and at the end of a step. `query`: about intersections, impacts or proximities; with
/// Output::first, only the first impact is listed. Throws the same Error on all ranks: invalid_argument if an option is
/// not supported for several ranks, otherwise as the search of a single process does. An error that occurs on one rank
/// only aborts the processes of all ranks, because they would wait for it forever.
template <class Query>
int search_on_ranks(const SearchCommand& command, const std::vector<std::string>& files, const Query& query);

}  // namespace crumple::cli
