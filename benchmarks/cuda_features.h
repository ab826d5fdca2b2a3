#pragma once

// Benchmark of feature queries about a mesh that moves on the device (step.h): impacts, the first impact, proximities,
// candidates. Arrays and results stay on the device.

#include <string>

#include "crumple/options.h"
#include "report.h"

namespace crumple::benchmark {

Table table_of_steps();

/// Times each query about the step `name` by `frames` launches after a warm-up: on the device by events, on a stream
/// that is kept busy until the graph is enqueued; by the host's clock, including wait(); and on the cpu backend with
/// all threads. Compares the results of both backends (comparison.h). Adds rows to the table, and passes each row of
/// figures to `add` once it is measured.
void measure_step(const std::string& name, const Options& options, int frames, Table& table, const RowSink& add);

/// Runs `frames` launches of impacts, of proximities and of candidates. The range that a profiler records is the last
/// launch of each.
void play_step(const std::string& name, const Options& options, int frames);

}  // namespace crumple::benchmark
