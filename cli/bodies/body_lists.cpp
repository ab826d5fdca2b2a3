#include "cli/bodies/body_lists.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "cli/bodies_of_files.h"
#include "io/lists/list_rows.h"

namespace crumple::cli {
namespace {

std::string as_json(const nlohmann::json& value) {
    return value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// Returns a time as a JSON number, rounded to microseconds.
std::string as_json_time(double milliseconds) { return as_json(std::round(milliseconds * 1000) / 1000); }

const std::string& name(const std::vector<std::string>& names, std::int32_t b) {
    return names[static_cast<std::size_t>(b)];
}

std::string json_pair(const std::vector<std::string>& names, const BodyPair& pair) {
    return as_json({name(names, pair.first), name(names, pair.second)});
}

/// Returns the flags of pairs [begin, end) as a JSON list of true and false.
std::string json_inside(const std::vector<std::uint8_t>& inside, std::size_t begin, std::size_t end) {
    std::string text;
    for (std::size_t i = begin; i < end; ++i)
        text += std::string(i > begin ? "," : "") + (inside[i] ? "true" : "false");
    return '[' + text + ']';
}

void write_configuration(std::ostream& out, const ConfigurationList& list, std::size_t c) {
    out << "{\"" << list.verb << "\":" << (list.collides[c] ? "true" : "false");
    if (list.has_pairs) {
        out << R"(,"pairs":[)";
        const std::size_t begin = c ? list.ends[c - 1] : 0;
        for (std::size_t i = begin; i < list.ends[c]; ++i)
            out << (i > begin ? "," : "") << json_pair(list.names, list.pairs[i]);
        out << ']';
        if (list.has_inside) out << R"(,"inside":)" << json_inside(list.inside, begin, list.ends[c]);
    }
    out << '}';
}

}  // namespace

std::int64_t ConfigurationList::colliding() const {
    return std::count_if(collides.begin(), collides.end(), [](std::uint8_t c) { return c != 0; });
}

void write_list(std::ostream& out, const BodyList& list, ListFormat format) {
    if (format == ListFormat::json) {
        out << "{\n\"bodies\": " << as_json(list.names) << ",\n\"pairs\": [";
        for (std::size_t i = 0; i < list.pairs.size(); ++i)
            out << (i ? ",\n" : "\n") << json_pair(list.names, list.pairs[i]);
        out << ']';
        if (list.has_inside) out << ",\n\"inside\": " << json_inside(list.inside, 0, list.pairs.size());
        out << ",\n\"milliseconds\": " << as_json_time(list.statistics.milliseconds) << "\n}\n";
        return;
    }
    const bool csv = format == ListFormat::csv;
    const auto written = [&](std::int32_t b) {
        return csv ? io::csv_cell(name(list.names, b)) : quoted_name(name(list.names, b));
    };
    if (csv) out << (list.has_inside ? "first,second,inside\n" : "first,second\n");
    for (std::size_t i = 0; i < list.pairs.size(); ++i) {
        const auto [first, second] = list.pairs[i];
        out << written(first) << (csv ? ',' : '\t') << written(second);
        if (list.has_inside) out << (csv ? (list.inside[i] ? ",1" : ",0") : (list.inside[i] ? "\tinside" : ""));
        out << '\n';
    }
}

void write_list(std::ostream& out, const ConfigurationList& list, ListFormat format) {
    const std::size_t count = list.collides.size();
    if (format == ListFormat::json) {
        out << "{\n\"bodies\": " << as_json(list.names) << ",\n\"configurations\": [";
        for (std::size_t c = 0; c < count; ++c) {
            out << (c ? ",\n" : "\n");
            write_configuration(out, list, c);
        }
        out << "],\n\"milliseconds\": " << as_json_time(list.milliseconds) << "\n}\n";
        return;
    }
    const bool csv = format == ListFormat::csv;
    const char between = csv ? ',' : ' ';
    if (csv)
        out << "configuration," << list.verb << (list.has_pairs ? ",pairs" : "")
            << (list.has_inside ? ",inside\n" : "\n");
    for (std::size_t c = 0; c < count; ++c) {
        out << c << between << (csv ? (list.collides[c] ? "1" : "0") : (list.collides[c] ? "yes" : "no"));
        const std::size_t begin = c && list.has_pairs ? list.ends[c - 1] : 0;
        if (list.has_pairs) out << between << list.ends[c] - begin;
        if (list.has_inside)
            out << between
                << std::count(list.inside.begin() + static_cast<std::ptrdiff_t>(begin),
                              list.inside.begin() + static_cast<std::ptrdiff_t>(list.ends[c]), 1);
        out << '\n';
    }
}

}  // namespace crumple::cli
