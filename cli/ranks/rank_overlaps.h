#pragma once

// Search for overlaps of bodies by several MPI processes, each of which has read all files.

#include "crumple/error.h"
#include "crumple/function_ref.h"
#include "crumple/options.h"
#include "crumple/overlaps.h"
#include "crumple/world.h"

namespace crumple::cli {

/// Parts of a command about overlaps that a rank runs.
struct RankOverlapSearch {
    Options options;
    FunctionRef<World()> read;               ///< returns the world, which all ranks must read alike; may throw Error
    FunctionRef<OverlapQuery()> query;       ///< returns the query; called after read()
    FunctionRef<Error(const Error&)> named;  ///< adds the name of the file to an error
    FunctionRef<int(const Overlaps& found)> write;  ///< writes the whole result and returns the status; on rank 0 only
};

/// Collective. Finds the overlaps: rank r provides bodies r, r + n, ... of n ranks. Returns the same exit status on all
/// ranks. Throws the same Error on all ranks.
int overlaps_on_ranks(const RankOverlapSearch& search);

}  // namespace crumple::cli
