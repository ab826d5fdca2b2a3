#pragma once

// crumple near and crumple impacts on several processes of MPI: one mesh, of which each reads, searches and writes its
// part.

#include <string>

#include "cli/feature_outputs.h"
#include "crumple/impacts.h"
#include "crumple/proximities.h"

namespace crumple::cli {

/// Called by all ranks (ranks.h), return the same status on all. Throw Error, the same on all ranks: invalid_argument
/// for what is not shared among ranks, else as the search of one process does.
int impacts_on_ranks(const FeatureCommand& command, const std::string& start, const std::string& end,
                     const ImpactQuery& question, bool earliest);
int near_on_ranks(const FeatureCommand& command, const std::string& file, const ProximityQuery& question);

}  // namespace crumple::cli
