#pragma once

// Benchmark of many small worlds in one call on the device.

#include "crumple/options.h"
#include "report.h"

namespace crumple::benchmark {

Table table_of_worlds();

/// Times many small worlds in one call, from and to the host. Each has two bodies of 500 triangles, further apart from
/// world to world until they are clear of each other. The sum of the stages is the device's part of that. Then times
/// the same as steps of a simulation on the device, where poses and results lie: launch and wait by the host's clock.
/// Medians of `frames` steps, and of at most 5 calls from the host. Results are compared with the cpu backend's
/// (comparison.h). Adds rows to the table, and passes each row of figures to `add` once it is measured.
void measure_worlds(int count, const Options& options, int frames, Table& table, const RowSink& add);

}  // namespace crumple::benchmark
