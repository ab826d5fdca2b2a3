#pragma once

#include "workload.h"

namespace crumple::benchmark {

/// Serves another process that wants to take turns with crumple: reads requests from standard input, a line each, and
/// answers each with a line on standard output. The detectors stay warm in between.
///
///     dump FOLDER     writes the workload and its answer as raw arrays; answers their description as JSON
///     parts N FOLDER  writes for each triangle which of N parts it belongs to, a bit each of a uint64; answers N
///     processors      answers how many are at hand (race.h)
///     run THREADS S   calls for S seconds, at least once, with 1 thread or 0, all; answers the milliseconds of each
///     call
void serve(const Workload& workload);

}  // namespace crumple::benchmark
