#pragma once

// Contests: races of crumple against its peers on a workload, with comparison of the results.

#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "race.h"
#include "workload.h"

namespace crumple::benchmark {

struct Difference {
    std::int64_t missing;  ///< pairs that only crumple found
    std::int64_t extra;    ///< pairs that only the peer found
};

/// Returns the names of the peers that this program was built with.
std::vector<std::string> built_peers();

/// Describes each peer for people and for the report: name, version, scalar type, threads and what exactly it computes;
/// or why it is left out.
nlohmann::json describe_peers();

/// Returns the contestants of the named peers, one for each method (Contestant::way). Peers that do not support the
/// workload's query have no contestants.
std::vector<Contestant> peer_contestants(const Workload& workload, std::span<const std::string> peers);

/// Races crumple against `peers` on one workload, prints a table and returns the same as JSON.
nlohmann::json contest(const Workload& workload, std::span<const std::string> peers, const Effort& effort);

}  // namespace crumple::benchmark
