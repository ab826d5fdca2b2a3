#pragma once

#include <cstdint>
#include <string>

#include "crumple/intersections.h"

namespace crumple::cli {

/// Triangles that take part in some pair.
std::int64_t count_hits(const Intersections& collisions);

/// The answer in one line: "925 pairs, 941 of 54,928 triangles, 4.4 ms". `what`: triangles or polygons.
std::string summary_of_pairs(std::int64_t pairs, std::int64_t hits, std::int64_t all, const char* what,
                             double milliseconds);

/// What --stats prints, to standard error. `hits`: colliding triangles.
void print_statistics(const Statistics& statistics, std::int64_t hits);
/// The same with this remark on the pairs.
void print_statistics(const Statistics& statistics, const std::string& remark);

/// Adds one call's counts and times to a sum; the peak memory is the larger one.
void add(Statistics& sum, const Statistics& more);

}  // namespace crumple::cli
