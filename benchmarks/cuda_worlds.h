#pragma once

// Many small worlds in one call.

#include "crumple/options.h"
#include "report.h"

namespace crumple::benchmark {

Table table_of_worlds();

/// Many small worlds in one call, from and to the host: a body of 500 triangles twice in each, further apart from world
/// to world until they are clear of each other. What the device takes of it is the sum of the stages. Then the same as
/// steps of a simulation on the device, which has the poses and gets the answer: launch and wait by the host's clock.
/// Medians of `frames` calls. Results are compared with the cpu backend's (comparison.h). Adds rows to the table, and
/// gives each row of figures to `add` when it is known.
void measure_worlds(int count, const Options& options, int frames, Table& table, const RowSink& add);

}  // namespace crumple::benchmark
