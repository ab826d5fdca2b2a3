#pragma once

// Crumple against its peers on a workload, and what came out of it.

#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "race.h"
#include "workload.h"

namespace crumple::benchmark {

struct Difference {
    std::int64_t missing;  ///< pairs that crumple has and the other has not
    std::int64_t extra;    ///< the reverse
};

/// Names of the peers that this program was built with.
std::vector<std::string> built_peers();

/// For people and for the report: name, version, scalar type, threads and what exactly each computes; or why it is left
/// out.
nlohmann::json describe_peers();

/// Those that are named, each in all its ways; none of a peer that cannot answer the workload's question.
std::vector<Contestant> peer_contestants(const Workload& workload, std::span<const std::string> peers);

/// Races crumple against `peers` on one workload, prints a table and returns the same as JSON.
nlohmann::json contest(const Workload& workload, std::span<const std::string> peers, const Effort& effort);

}  // namespace crumple::benchmark
