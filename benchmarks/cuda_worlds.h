#pragma once

// Many small worlds in one call.

#include <nlohmann/json.hpp>

#include "crumple/options.h"
#include "report.h"

namespace crumple::benchmark {

Table table_of_worlds();

/// Many small worlds in one call, from and to the host: a body of 500 triangles twice in each, further apart from world
/// to world until they are clear of each other. What the device takes of it is the sum of the stages. Then the same as
/// steps of a simulation on the device, which has the poses and gets the answer: launch and wait by the host's clock.
/// Medians of `frames` calls. Adds rows to the table. Throws std::runtime_error if answers differ.
nlohmann::json measure_worlds(int count, const Options& options, int frames, Table& table);

}  // namespace crumple::benchmark
