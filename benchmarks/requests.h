#pragma once

#include "workload.h"

namespace crumple::benchmark {

/// Serves another process that takes turns with crumple: reads requests from standard input, one per line, and replies
/// to each with a line on standard output. The detectors stay warm in between.
///
///     dump FOLDER     writes the workload and its result as raw arrays; replies with their description as JSON
///     parts N FOLDER  writes the parts (of N) of each triangle as bits of a uint64; replies with N
///     processors      replies with the number of processors at hand (race.h)
///     run THREADS S   calls for S seconds, at least once, on 1 thread or all (0); replies with each call's
///     milliseconds
void serve(const Workload& workload);

}  // namespace crumple::benchmark
