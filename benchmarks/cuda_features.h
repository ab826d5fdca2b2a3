#pragma once

// Questions about the features of a mesh that moves on the device (step.h): impacts, the first one, what is near,
// candidates. Arrays and answers stay there.

#include <string>

#include "crumple/options.h"
#include "report.h"

namespace crumple::benchmark {

Table table_of_steps();

/// Each question by `frames` launches after a warm-up: on the device by events, on a stream that was kept busy until
/// the graph was there; by the host's clock, with the wait; and the cpu backend on all threads, whose result is
/// compared (comparison.h). Adds rows to the table, and gives each row of figures to `add` when it is known.
void measure_step(const std::string& name, const Options& options, int frames, Table& table, const RowSink& add);

/// Plays `frames` launches of impacts, of what is near and of candidates, for a profiler, which is told to look at the
/// last one of each.
void play_step(const std::string& name, const Options& options, int frames);

}  // namespace crumple::benchmark
