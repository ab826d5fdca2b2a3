#include "report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace crumple::benchmark {

void Table::print() const {
    std::vector<std::size_t> widths;
    for (const auto& row : rows_) {
        widths.resize(std::max(widths.size(), row.size()));
        for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
    }
    fmt::print("\n{}\n", title_);
    for (const auto& row : rows_) {
        std::string line;
        for (std::size_t c = 0; c < row.size(); ++c) {
            const bool text = !row[c].empty() && std::isalpha(static_cast<unsigned char>(row[c].front()));
            line += text ? fmt::format("  {:<{}}", row[c], widths[c]) : fmt::format("  {:>{}}", row[c], widths[c]);
        }
        fmt::print("{}\n", line);
    }
    std::fflush(stdout);
}

std::string number(double value) {
    const double magnitude = value == 0 ? 0 : std::floor(std::log10(std::abs(value)));
    return fmt::format("{:.{}f}", value, static_cast<int>(std::clamp(2 - magnitude, 0.0, 6.0)));
}

std::string range(const Summary& summary) {
    return fmt::format("{} - {}", number(summary.lower_quartile), number(summary.upper_quartile));
}

double exponent(std::span<const double> x, std::span<const double> y) {
    double sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double lx = std::log(x[i]), ly = std::log(y[i]);
        sx += lx, sy += ly, sxx += lx * lx, sxy += lx * ly;
    }
    const auto n = static_cast<double>(x.size());
    return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

nlohmann::json to_json(const Summary& summary) {
    return {{"median", summary.median},
            {"lower_quartile", summary.lower_quartile},
            {"upper_quartile", summary.upper_quartile}};
}

nlohmann::json with_percentile_99(const Summary& summary) {
    nlohmann::json row = to_json(summary);
    row["percentile_99"] = summary.percentile_99;
    return row;
}

namespace {

bool has_list(const nlohmann::json& value) {
    return value.is_array() || (value.is_object() && std::ranges::any_of(value, has_list));
}

void write_lines(std::ostream& out, const nlohmann::json& value, const std::string& indent) {
    const auto nested = [](const nlohmann::json& item) { return item.is_structured(); };
    const bool apart = value.is_array() ? std::ranges::any_of(value, nested) : has_list(value);
    if (!apart) {
        out << value.dump();
        return;
    }
    const char* separator = "\n";
    out << (value.is_array() ? "[" : "{");
    for (const auto& [key, item] : value.items()) {
        out << separator << indent << ' ';
        if (value.is_object()) out << nlohmann::json(key).dump() << ": ";
        write_lines(out, item, indent + ' ');
        separator = ",\n";
    }
    out << '\n' << indent << (value.is_array() ? "]" : "}");
}

}  // namespace

void write_json(const std::string& path, const nlohmann::json& figures) {
    const std::string part = path + ".part";
    {
        std::ofstream file(part);
        write_lines(file, figures, "");
        if (!(file << '\n').flush()) throw std::runtime_error("cannot write " + part);
    }
    std::filesystem::rename(part, path);
}

}  // namespace crumple::benchmark
