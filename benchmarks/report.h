#pragma once

// Tables for people, JSON for machines.

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "race.h"

namespace crumple::benchmark {

/// Columns as wide as they need to be; the first is aligned to the left, numbers to the right.
class Table {
   public:
    Table(std::string title, std::vector<std::string> header) : title_(std::move(title)), rows_{std::move(header)} {}
    void row(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
    void print() const;

   private:
    std::string title_;
    std::vector<std::vector<std::string>> rows_;
};

/// Three significant digits.
std::string number(double value);
/// "lower - upper" quartile.
std::string range(const Summary& summary);

/// Slope of the least squares line through (log x, log y).
double exponent(std::span<const double> x, std::span<const double> y);

/// Takes a row of figures as soon as it is known.
using RowSink = std::function<void(nlohmann::json)>;

/// Median and quartiles.
nlohmann::json to_json(const Summary& summary);
/// And the 99th percentile, for what a simulation waits for.
nlohmann::json with_percentile_99(const Summary& summary);

/// Writes one record a line, as benchmarks/figures.py does, and replaces the file at once: a reader never sees half of
/// it. Throws std::runtime_error.
void write_json(const std::string& path, const nlohmann::json& figures);

}  // namespace crumple::benchmark
