#pragma once

// Benchmark of many small worlds in one call on the device.

#include "crumple/options.h"
#include "report.h"

namespace crumple::benchmark {

Table table_of_worlds();

/// Times one call about `count` small worlds, from and to the host. Each world has two bodies of 500 triangles, whose
/// distance grows from world to world until they do not collide. "stages", the sum of the stages' times, is the
/// device's part of that call. Then times the same query as steps of a simulation on the device, where poses and
/// results lie: launch and wait by the host's clock. Figures are medians of `frames` steps, and of at most 5 calls from
/// the host. Results are compared with those of the cpu backend (comparison.h). Adds rows to the table, and passes each
/// row of figures to `add` once it is measured.
void measure_worlds(int count, const Options& options, int frames, Table& table, const RowSink& add);

}  // namespace crumple::benchmark
