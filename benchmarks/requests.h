#pragma once

#include "workload.h"

namespace crumple::benchmark {

/// Serves another process that times crumple and peers alternately: reads requests from standard input, one per line,
/// and replies to each with a line on standard output. The detectors stay warm between requests.
///
///     dump FOLDER     writes the workload and its result as raw arrays; replies with their description as JSON
///     parts N FOLDER  splits the first mesh into N parts (at most 64); writes a uint64 per triangle, whose bit k is
///     set if
///                     the triangle is in part k; replies with N
///     processors      replies with processors_at_hand() (race.h)
///     run THREADS S   calls crumple for S seconds, at least once, on 1 thread or on all (THREADS is 0); replies with
///     the
///                     milliseconds of each call
void serve(const Workload& workload);

}  // namespace crumple::benchmark
