#pragma once

// The contestants for a workload, one file a library. Each gets the workload's coordinates in its own containers before
// the clock starts; what it derives from them (boxes, trees) is timed, unless the contestant's name says otherwise.

#include <vector>

#include "race.h"
#include "workload.h"

namespace crumple::benchmark {

/// One thread and all threads, warm: the detector has seen the mesh before, as in a simulation.
std::vector<Contestant> crumple_contestants(const Workload& workload);

// Empty if the library cannot answer the workload's question.
std::vector<Contestant> cgal_contestants(const Workload& workload);
std::vector<Contestant> cgal_box_contestants(const Workload& workload);
std::vector<Contestant> embree_contestants(const Workload& workload);
std::vector<Contestant> fcl_contestants(const Workload& workload);

}  // namespace crumple::benchmark
