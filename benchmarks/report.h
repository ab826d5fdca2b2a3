#pragma once

// Output of figures: tables for people, JSON for machines.

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "race.h"

namespace crumple::benchmark {

/// Table with columns as wide as needed. Cells that begin with a letter are aligned to the left, others to the right.
class Table {
   public:
    Table(std::string title, std::vector<std::string> header) : title_(std::move(title)), rows_{std::move(header)} {}
    void row(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
    void print() const;

   private:
    std::string title_;
    std::vector<std::vector<std::string>> rows_;
};

/// Formats a number with three significant digits, but with all digits before the point and at most six after it.
std::string number(double value);
/// Formats the quartiles as "lower - upper".
std::string range(const Summary& summary);

/// Returns the slope of the least squares line through (log x, log y).
double exponent(std::span<const double> x, std::span<const double> y);

/// Callback that receives rows of figures, each as soon as it is measured.
using RowSink = std::function<void(nlohmann::json)>;

/// Returns median and quartiles as JSON.
nlohmann::json to_json(const Summary& summary);
/// Returns median, quartiles and 99th percentile as JSON. The percentile matters for calls that a simulation waits for.
nlohmann::json with_percentile_99(const Summary& summary);

/// Writes figures to a file, one record per line, as benchmarks/figures.py does. Replaces the file atomically: a reader
/// never sees an incomplete file. Throws std::runtime_error.
void write_json(const std::string& path, const nlohmann::json& figures);

}  // namespace crumple::benchmark
