// Impacts, near pairs and candidates from text and CSV; the format by extension.

#include "io/lists/read_features.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "base/float_environment.h"
#include "io/bytes/text.h"
#include "io/formats.h"
#include "io/lists/pairs.h"

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
std::string take_ids(std::span<const std::string_view> words, CandidateRow& row, bool& has_bodies) {
    for (std::size_t k = 0; k < words.size(); ++k) {
        const std::optional<Id> id = id_of(words[k]);
        const std::size_t first = first_ids(row.kind), side = k < first ? 0 : 1;
        const bool face = feature_of(row.kind, side) == Feature::face;
        if (!id) return in_quotes(words[k]) + " names no " + (face ? "face" : "vertex");
        if (k > 0 && id->has_body != has_bodies) return "some ids have the number of a file and some do not";
        has_bodies = id->has_body;
        std::int32_t& body = side == 0 ? row.bodies.first : row.bodies.second;
        const bool second_end = is_edge(row.kind, side) && k == (side == 0 ? 1 : first + 1);
        if (second_end && body != id->body) return "an edge has vertices of two files";
        body = id->body;
        row.ids[k] = id->index;
    }
    return {};
}

/// The value, and perhaps the flag. Says what is wrong; empty: nothing.
std::string take_value(std::span<const std::string_view> words, FeatureRow& row) {
    const auto value = number_of(words[0]);
    if (!value) return in_quotes(words[0]) + " is no number";
    row.value = *value;
    row.flag = row.value == 0;
    if (words.size() == 1) return {};
    if (words[1] != "0" && words[1] != "1") return in_quotes(words[1]) + " is neither 0 nor 1";
    row.flag = words[1] == "1";
    return {};
}

/// Ids and what follows them. Says what is wrong; empty: nothing.
std::string add_row(FeatureRows& rows, CandidateKind kind, std::span<const std::string_view> words) {
    const bool has_values = rows.words().has_values();
    FeatureRow row;
    row.kind = kind;
    const std::size_t ids = id_count(kind), least = ids + (has_values ? 1 : 0), most = ids + (has_values ? 2 : 0);
    if (words.size() < least)
        return "`" + std::string(short_name(kind)) + "` is followed by " + std::to_string(ids) + " ids" +
               (has_values ? " and a number" : "");
    bool has_bodies = false;
    std::string mistake = take_ids(words.first(ids), row, has_bodies);
    if (mistake.empty() && has_values) mistake = take_value(words.subspan(ids), row);
    if (!mistake.empty()) return mistake;
    if (words.size() > most) return in_quotes(words[most]) + " is left over";
    return rows.add(row, has_bodies);
}

std::optional<CandidateKind> kind_of(std::string_view word, const FeatureRows& rows) {
    for (const CandidateKind kind : all_kinds)
        if (word == short_name(kind) && rows.words().has(kind)) return kind;
    return std::nullopt;
}

std::string no_kind(std::string_view word, const FeatureRows& rows) {
    std::string names;
    for (const CandidateKind kind : all_kinds) {
        if (!rows.words().has(kind)) continue;
        if (!names.empty()) names += kind == CandidateKind::vertex_vertex ? " and " : ", ";
        names += short_name(kind);
    }
    return in_quotes(word) + " is none of " + names;
}

void read_txt(const Source& source, FeatureRows& rows) {
    Scanner in(source, {.lines = true, .comments = true});
    std::vector<std::string_view> words;
    for (; in.next_line_with_items(); in.skip_line()) {
        const char* const line = in.position();
        const std::string_view name = in.word();
        const auto kind = kind_of(name, rows);
        if (!kind) in.fail(line, no_kind(name, rows));
        words.clear();
        while (!in.finished()) words.push_back(in.word());
        const std::string mistake = add_row(rows, *kind, words);
        if (!mistake.empty()) in.fail(line, mistake);
    }
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

/// kind, vertex, face, a, b, c, d, value, flag, of which the last may be missing; candidates end with d. Cells of
/// other kinds are empty.
std::string add_fields(FeatureRows& rows, const std::vector<std::string_view>& fields) {
    const auto kind = kind_of(fields[0], rows);
    if (!kind) return no_kind(fields[0], rows);
    const bool has_values = rows.words().has_values();
    constexpr std::size_t first_id = 1;
    const std::size_t value = first_id + most_id_columns;
    const std::size_t least = value + (has_values ? 1 : 0), most = value + (has_values ? 2 : 0);
    if (fields.size() < least || fields.size() > most)
        return std::to_string(fields.size()) + " columns in place of " + std::to_string(most);
    const auto ids = id_columns(*kind);
    std::vector<std::string_view> words;
    for (const std::size_t column : ids) words.push_back(fields[first_id + column]);
    for (std::size_t i = first_id; i < value; ++i) {
        const bool wanted = std::find(ids.begin(), ids.end(), i - first_id) != ids.end();
        if (!wanted && !fields[i].empty()) return in_quotes(fields[i]) + " is in a column of another kind";
    }
    for (std::size_t i = value; i < fields.size(); ++i) words.push_back(fields[i]);
    return add_row(rows, *kind, words);
}

void read_csv(const Source& source, FeatureRows& rows) {
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
}

void read(const Source& source, FeatureRows rows) {
    const FloatEnvironment environment;
    const std::string extension = extension_of(source.name());
    try {
        if (extension == ".csv") return read_csv(source, rows);
        if (extension == ".json") return read_features_json(source, rows);
        if (extension == ".npz") return read_features_npz(source, rows);
        read_txt(source, rows);
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::file, "cannot read " + source.name() + ": its rows do not fit in memory");
    }
}

FeatureList read(const Source& source, const FeatureWords& words) {
    FeatureList list;
    read(source, FeatureRows(words, list));
    return list;
}
CandidateRows read_rows_of_candidates(const Source& source) {
    CandidateRows list;
    read(source, FeatureRows(list));
    return list;
}

/// What is wrong with the numbers of a row; empty: nothing.
std::string check_value(const FeatureRow& row, const FeatureWords& words) {
    const bool motion = words.value == impact_words.value;
    if (motion && !(row.value >= 0 && row.value <= 1)) return "a time of contact lies in [0, 1]";
    if (!(row.value >= 0)) return "a squared distance is 0 or more";
    if (row.flag && row.value != 0) return "what touches has " + std::string(words.value) + " 0";
    return {};
}

}  // namespace

std::string FeatureRows::add(FeatureRow row, bool has_bodies) {
    if (words_.has_values())
        if (std::string mistake = check_value(row, words_); !mistake.empty()) return mistake;
    if (has_bodies_.value_or(has_bodies) != has_bodies) return "some ids have the number of a file and some do not";
    const std::size_t second = first_ids(row.kind);
    if ((is_edge(row.kind, 0) && row.ids[0] == row.ids[1]) ||
        (is_edge(row.kind, 1) && row.ids[second] == row.ids[second + 1]))
        return "an edge names a vertex twice";
    put_in_order(row);
    has_bodies_ = has_bodies;
    if (candidates_) {
        candidates_->has_bodies = has_bodies;
        candidates_->rows.push_back(row);
    } else {
        features_->has_bodies = has_bodies;
        features_->rows.push_back(row);
    }
    return {};
}

FeatureList read_impacts(const std::filesystem::path& path) { return read(Source(path), impact_words); }
FeatureList read_impacts(std::istream& in, const std::string& name) { return read(Source(in, name), impact_words); }

FeatureList read_near(const std::filesystem::path& path) { return read(Source(path), near_words); }
FeatureList read_near(std::istream& in, const std::string& name) { return read(Source(in, name), near_words); }

CandidateRows read_candidates(const std::filesystem::path& path) { return read_rows_of_candidates(Source(path)); }
CandidateRows read_candidates(std::istream& in, const std::string& name) {
    return read_rows_of_candidates(Source(in, name));
}

}  // namespace crumple::io
