#pragma once

// Contestants for a workload, one file per library. Each gets the workload's coordinates in its own containers before
// the clock starts. Making boxes and trees from them is timed, except for contestants named "trees built".

#include <vector>

#include "race.h"
#include "workload.h"

namespace crumple::benchmark {

/// Returns two contestants: crumple on one thread and on all threads. Each has a detector that stays warm, as in a
/// simulation.
std::vector<Contestant> crumple_contestants(const Workload& workload);

// Contestants of each library; empty if it does not support the workload's query.
std::vector<Contestant> cgal_contestants(const Workload& workload);
std::vector<Contestant> cgal_box_contestants(const Workload& workload);
std::vector<Contestant> embree_contestants(const Workload& workload);
std::vector<Contestant> fcl_contestants(const Workload& workload);

}  // namespace crumple::benchmark
