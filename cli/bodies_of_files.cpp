#include "cli/bodies_of_files.h"

#include <algorithm>
#include <cctype>
#include <iostream>
#include <iterator>
#include <numeric>
#include <optional>

#include <nlohmann/json.hpp>

#include "cli/closest_word.h"
#include "cli/printed_units.h"
#include "cli/search.h"
#include "cli/terminal.h"
#include "crumple/error.h"
#include "io/bytes/source.h"
#include "io/scenes/body_names.h"
#include "io/scenes/world_mesh.h"

namespace crumple::cli {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

io::WorldMesh read_one(const std::string& file, const io::ReadOptions& how) {
    io::WorldMesh world =
        is_standard(file) ? io::read_world(std::cin, "standard input", how) : io::read_world(file, how);
    for (const std::string& warning : world.warnings) print_warning(warning);
    return world;
}

/// Removes the third field of a line, which detect --containment writes after two names.
void drop_inside(std::vector<std::string>& fields) {
    if (fields.size() == 3 && (fields[2] == "inside" || fields[2] == "1" || fields[2] == "0")) fields.pop_back();
}

/// Splits a line of a text list into two names. Returns nothing if the line has more or fewer names.
std::optional<std::pair<std::string, std::string>> split(std::string_view line) {
    const bool by_tab = line.find('\t') != line.npos;
    std::vector<std::string> words;
    while (true) {
        while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
        if (line.empty()) break;
        if (line.front() == '"') {  // the name ends at the next quote without a backslash
            std::size_t end = 1;
            while (end < line.size() && line[end] != '"') end += line[end] == '\\' ? 2 : 1;
            if (end >= line.size()) return std::nullopt;
            const auto name = nlohmann::json::parse(line.substr(0, end + 1), nullptr, false);
            if (!name.is_string()) return std::nullopt;
            words.push_back(name.get<std::string>());
            line.remove_prefix(end + 1);
            continue;
        }
        const auto ends = [&](char c) { return by_tab ? c == '\t' : is_blank(c); };
        const auto end = std::find_if(line.begin(), line.end(), ends);
        std::string_view word = line.substr(0, static_cast<std::size_t>(end - line.begin()));
        line.remove_prefix(word.size());
        while (!word.empty() && is_blank(word.back())) word.remove_suffix(1);
        words.emplace_back(word);
    }
    drop_inside(words);
    if (words.size() != 2) return std::nullopt;
    return std::pair(words[0], words[1]);
}

/// Calls take(fields, place) for each record of CSV: fields may be quoted; quoted fields may contain doubled quotes and
/// line breaks. Blank lines are skipped.
template <class Take>
void for_each_record(const io::Source& source, Take take) {
    const char* p = source.text_begin();
    const auto ends_line = [&] { return p == source.end() || *p == '\n' || *p == '\r'; };
    while (p != source.end()) {
        const char* const place = p;
        std::vector<std::string> fields;
        do {
            std::string& field = fields.emplace_back();
            if (p != source.end() && *p == '"') {
                for (++p; p != source.end() && (*p != '"' || (p + 1 != source.end() && p[1] == '"')); ++p) {
                    field += *p;
                    if (*p == '"') ++p;
                }
                if (p != source.end()) ++p;
            }
            while (!ends_line() && *p != ',') field += *p++;
        } while (!ends_line() && *p++ == ',');
        if (fields.size() > 1 || !fields[0].empty()) take(fields, place);
        if (p != source.end()) ++p;
    }
}

}  // namespace

void refuse(const std::string& what) { throw Error(ErrorCode::invalid_argument, what, Element::option); }

io::WorldMesh read_bodies(const std::vector<std::string>& files, const ReadingOptions& options,
                          std::vector<std::string>* file_of_body) {
    check_standard_input(files);
    io::WorldMesh all;
    io::CommonUnit unit = common_unit(options.strict);
    for (const std::string& file : files) {
        io::WorldMesh world = read_one(file, read_options(options));
        unit.apply(file, world);
        io::append(std::move(world), all);
        if (file_of_body) file_of_body->resize(all.bodies.size(), file);
    }
    io::make_names_unique(all.bodies);
    return all;
}

BodyNames::BodyNames(const std::vector<io::NamedBody>& bodies) : sorted_(bodies.size()) {
    for (const io::NamedBody& body : bodies) names_.push_back(body.name);
    std::iota(sorted_.begin(), sorted_.end(), 0);
    const auto name = [&](std::int32_t b) -> const std::string& { return names_[static_cast<std::size_t>(b)]; };
    std::sort(sorted_.begin(), sorted_.end(), [&](std::int32_t a, std::int32_t b) { return name(a) < name(b); });
}

std::int32_t BodyNames::find(const std::string& name) const {
    const auto found = std::lower_bound(
        sorted_.begin(), sorted_.end(), name,
        [&](std::int32_t b, const std::string& name) { return names_[static_cast<std::size_t>(b)] < name; });
    return found != sorted_.end() && names_[static_cast<std::size_t>(*found)] == name ? *found : -1;
}

std::int32_t BodyNames::require(const std::string& name) const {
    const std::int32_t body = find(name);
    if (body >= 0) return body;
    const std::string* const meant = nearest(name, names_);
    refuse("there is no body " + quoted_name(name) + (meant ? "; did you mean " + quoted_name(*meant) + "?" : ""));
}

BodyPair BodyNames::pair(const std::string& text) const {
    for (std::size_t comma = text.find(','); comma != text.npos; comma = text.find(',', comma + 1)) {
        const std::int32_t a = find(text.substr(0, comma)), b = find(text.substr(comma + 1));
        if (a >= 0 && b >= 0) return {a, b};
    }
    const std::size_t comma = text.find(',');
    if (comma == text.npos) refuse("--excluded-bodies " + text + ": two names are expected, A,B");
    try {
        return {require(text.substr(0, comma)), require(text.substr(comma + 1))};
    } catch (const Error& error) {
        refuse("--excluded-bodies " + text + ": " + error.what());
    }
}

std::vector<BodyPair> BodyNames::read_pairs(const std::string& path) const {
    const io::Source source(path);
    const std::string extension = extension_of(path);
    const auto named = [&](const std::pair<std::string, std::string>& names, const char* place) -> BodyPair {
        try {
            return {require(names.first), require(names.second)};
        } catch (const Error& error) {
            source.fail_at_line(place, error.what());
        }
    };
    std::vector<BodyPair> pairs;
    if (extension == ".csv") {
        for_each_record(source, [&](std::vector<std::string> fields, const char* place) {
            drop_inside(fields);
            if (fields.size() != 2) source.fail_at_line(place, "two names are expected, separated by a comma");
            if (place != source.text_begin() || fields != std::vector<std::string>{"first", "second"})
                pairs.push_back(named({fields[0], fields[1]}, place));
        });
        return pairs;
    }
    if (extension == ".json") {
        const auto json = nlohmann::json::parse(source.text_begin(), source.end(), nullptr, false);
        if (json.is_discarded()) source.fail_at_byte(source.begin(), "this is not JSON");
        if (!json.is_object() || !json.contains("pairs") || !json["pairs"].is_array())
            source.fail_at_byte(source.begin(), "an object with a list of pairs of names is expected");
        for (const auto& pair : json["pairs"]) {
            if (!pair.is_array() || pair.size() != 2 || !pair[0].is_string() || !pair[1].is_string())
                source.fail_at_byte(source.begin(), "the list 'pairs' holds an entry that is not a pair of names");
            pairs.push_back(named({pair[0].get<std::string>(), pair[1].get<std::string>()}, source.begin()));
        }
        return pairs;
    }
    for (const char* begin = source.text_begin(); begin != source.end();) {
        const char* const end = std::find(begin, source.end(), '\n');
        const std::string_view line(begin, static_cast<std::size_t>(end - begin));
        const auto first = std::find_if_not(line.begin(), line.end(), is_blank);
        if (first != line.end() && *first != '#') {
            const auto names = split(line);
            if (!names) source.fail_at_line(begin, "two names are expected, separated by a tab");
            pairs.push_back(named(*names, begin));
        }
        begin = end == source.end() ? end : end + 1;
    }
    return pairs;
}

}  // namespace crumple::cli
