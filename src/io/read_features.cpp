// Impacts and near pairs from text and CSV; the format by extension.

#include "io/read_features.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "base/float_environment.h"
#include "io/formats.h"
#include "io/pairs.h"
#include "io/text.h"

namespace crumple::io {

namespace {

struct Id {
    std::int32_t body = 0, index = 0;
    bool has_body = false;
};

/// "17", or "1:17" of body 1; nothing for what is no id.
std::optional<Id> id_of(std::string_view word) {
    const auto number = [&]() -> std::optional<std::int32_t> {
        std::int64_t value = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (error != std::errc()) return std::nullopt;
        word.remove_prefix(static_cast<std::size_t>(end - word.data()));
        return triangle_index(value);
    };
    std::optional<std::int32_t> first = number(), second;
    if (!first) return std::nullopt;
    if (word.empty()) return Id{0, *first, false};
    if (!word.starts_with(':')) return std::nullopt;
    word.remove_prefix(1);
    second = number();
    return second && word.empty() ? std::optional(Id{*first, *second, true}) : std::nullopt;
}

/// A row whose ids are words. Says what is wrong with them; empty: nothing.
std::string take_ids(std::span<const std::string_view> words, FeatureRow& row, bool& has_bodies) {
    for (std::size_t k = 0; k < words.size(); ++k) {
        const std::optional<Id> id = id_of(words[k]);
        const bool face = row.kind == FeatureKind::vertex_face && k == 1;
        if (!id) return in_quotes(words[k]) + " names no " + (face ? "face" : "vertex");
        if (k > 0 && id->has_body != has_bodies) return "some ids have the number of a file and some do not";
        has_bodies = id->has_body;
        const std::size_t first = first_ids(row.kind), side = k < first ? 0 : 1;
        std::int32_t& body = side == 0 ? row.bodies.first : row.bodies.second;
        const bool second_end = is_edge(row.kind, side) && k == (side == 0 ? 1 : first + 1);
        if (second_end && body != id->body) return "an edge has vertices of two files";
        body = id->body;
        row.ids[k] = id->index;
    }
    return {};
}

/// Ids, the value, and perhaps the flag. Says what is wrong; empty: nothing.
std::string add_row(FeatureRows& rows, FeatureKind kind, std::span<const std::string_view> words) {
    FeatureRow row;
    row.kind = kind;
    const std::size_t ids = id_count(kind);
    if (words.size() <= ids)
        return "`" + std::string(short_name(kind)) + "` is followed by " + std::to_string(ids) + " ids and a number";
    bool has_bodies = false;
    if (std::string mistake = take_ids(words.first(ids), row, has_bodies); !mistake.empty()) return mistake;
    const auto value = number_of(words[ids]);
    if (!value) return in_quotes(words[ids]) + " is no number";
    row.value = *value;
    row.flag = row.value == 0;
    if (words.size() > ids + 1) {
        const std::string_view flag = words[ids + 1];
        if (flag != "0" && flag != "1") return in_quotes(flag) + " is neither 0 nor 1";
        row.flag = flag == "1";
    }
    if (words.size() > ids + 2) return in_quotes(words[ids + 2]) + " is left over";
    return rows.add(row, has_bodies);
}

std::optional<FeatureKind> kind_of(std::string_view word) {
    for (const FeatureKind kind : all_feature_kinds)
        if (word == short_name(kind)) return kind;
    return std::nullopt;
}

std::string no_kind(std::string_view word) { return in_quotes(word) + " is none of vf, ee, ve and vv"; }

FeatureList read_txt(const Source& source, FeatureRows rows) {
    Scanner in(source, {.lines = true, .comments = true});
    std::vector<std::string_view> words;
    for (; in.next_line_with_items(); in.skip_line()) {
        const char* const line = in.position();
        const std::string_view name = in.word();
        const auto kind = kind_of(name);
        if (!kind) in.fail(line, no_kind(name));
        words.clear();
        while (!in.finished()) words.push_back(in.word());
        const std::string mistake = add_row(rows, *kind, words);
        if (!mistake.empty()) in.fail(line, mistake);
    }
    return rows.take();
}

std::vector<std::string_view> fields_of(std::string_view line) {
    constexpr std::string_view blanks = " \t\r";
    std::vector<std::string_view> fields;
    for (bool ended = false; !ended;) {
        const std::size_t comma = line.find(',');
        std::string_view field = line.substr(0, comma);
        ended = comma == line.npos;
        line.remove_prefix(ended ? line.size() : comma + 1);
        field.remove_prefix(std::min(field.find_first_not_of(blanks), field.size()));
        fields.push_back(field.substr(0, field.find_last_not_of(blanks) + 1));
    }
    return fields;
}

/// kind, vertex, face, a, b, c, d, value, flag: cells of other kinds are empty, the last column may be missing.
std::string add_fields(FeatureRows& rows, const std::vector<std::string_view>& fields) {
    const auto kind = kind_of(fields[0]);
    if (!kind) return no_kind(fields[0]);
    constexpr std::size_t first_id = 1, value = first_id + most_id_columns, columns = value + 2;
    if (fields.size() <= value || fields.size() > columns)
        return std::to_string(fields.size()) + " columns in place of " + std::to_string(columns);
    const auto ids = id_columns(*kind);
    std::vector<std::string_view> words;
    for (std::size_t i = first_id; i < fields.size(); ++i) {
        const bool wanted = i >= value || std::find(ids.begin(), ids.end(), i - first_id) != ids.end();
        if (!wanted && !fields[i].empty()) return in_quotes(fields[i]) + " is in a column of another kind";
        if (wanted) words.push_back(fields[i]);
    }
    return add_row(rows, *kind, words);
}

FeatureList read_csv(const Source& source, FeatureRows rows) {
    for (const char* begin = source.text_begin(); begin != source.end();) {
        const char* const end = std::find(begin, source.end(), '\n');
        const std::string_view line(begin, static_cast<std::size_t>(end - begin));
        const auto fields = fields_of(line);
        const bool names = begin == source.text_begin() && fields[0] == "kind";
        if (!names && line.find_first_not_of(" \t\r") != line.npos) {
            const std::string mistake = add_fields(rows, fields);
            if (!mistake.empty()) source.fail_at_line(begin, mistake);
        }
        begin = end == source.end() ? end : end + 1;
    }
    return rows.take();
}

FeatureList read(const Source& source, const FeatureWords& words) {
    const FloatEnvironment environment;
    const std::string extension = extension_of(source.name());
    try {
        if (extension == ".csv") return read_csv(source, FeatureRows(words));
        if (extension == ".json") return read_features_json(source, words);
        if (extension == ".npz") return read_features_npz(source, words);
        return read_txt(source, FeatureRows(words));
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::file, "cannot read " + source.name() + ": its rows do not fit in memory");
    }
}

}  // namespace

std::string FeatureRows::add(FeatureRow row, bool has_bodies) {
    const bool motion = words_.value == impact_words.value;
    if (motion && !(row.value >= 0 && row.value <= 1)) return "a time of contact lies in [0, 1]";
    if (!(row.value >= 0)) return "a squared distance is 0 or more";
    if (row.flag && row.value != 0) return "what touches has " + std::string(words_.value) + " 0";
    if (!list_.rows.empty() && has_bodies != list_.has_bodies)
        return "some ids have the number of a file and some do not";
    list_.has_bodies = has_bodies;
    const std::size_t second = first_ids(row.kind);
    if ((is_edge(row.kind, 0) && row.ids[0] == row.ids[1]) ||
        (is_edge(row.kind, 1) && row.ids[second] == row.ids[second + 1]))
        return "an edge names a vertex twice";
    put_in_order(row);
    list_.rows.push_back(row);
    return {};
}

FeatureList read_impacts(const std::filesystem::path& path) { return read(Source(path), impact_words); }
FeatureList read_impacts(std::istream& in, const std::string& name) { return read(Source(in, name), impact_words); }

FeatureList read_near(const std::filesystem::path& path) { return read(Source(path), near_words); }
FeatureList read_near(std::istream& in, const std::string& name) { return read(Source(in, name), near_words); }

}  // namespace crumple::io
