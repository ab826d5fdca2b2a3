#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "crumple/intersections.h"

namespace crumple::cli {

/// Returns the number of triangles that are part of some pair.
std::int64_t count_hits(const Intersections& collisions);

/// Returns the result in one line: "925 pairs, 941 of 54,928 triangles, 4.4 ms". `what`: triangles or polygons.
std::string summary_of_pairs(std::int64_t pairs, std::int64_t hits, std::int64_t all, const char* what,
                             double milliseconds);

/// Prints a table of times, each with its percentage of the sum; name_of(i) returns the name of time i. print_row()
/// prints a row of the table of counts below it.
void print_times(std::string_view title, std::span<const double> milliseconds,
                 std::string_view (*name_of)(std::size_t));
void print_row(std::string_view name, const std::string& value, const std::string& remark = {});

/// Prints the table of --stats to standard error. `hits`: number of colliding triangles.
void print_statistics(const Statistics& statistics, std::int64_t hits);
/// Prints the table of --stats to standard error, with `remark` beside the number of pairs.
void print_statistics(const Statistics& statistics, const std::string& remark);

/// Adds the counts and times of one call to a sum. The peak memory becomes the larger of the two. The number of
/// threads, the backend and the instruction set become those of the call.
void add(Statistics& sum, const Statistics& more);

}  // namespace crumple::cli
