// Rows from the arrays of a .json or .npz, whatever order they came in; and .npz.

#include <algorithm>
#include <cmath>

#include "io/bytes/npy.h"
#include "io/bytes/npz.h"
#include "io/lists/pairs.h"
#include "io/lists/read_features.h"

namespace crumple::io {

namespace {

// The arrays of one kind, then those of edges.
enum Of { pairs, bodies, values, flags, arrays_of_a_kind, edges = candidate_kinds * arrays_of_a_kind, first_edge };

std::optional<std::int32_t> index_of(double value) {
    if (!(value >= 0 && value <= INT32_MAX) || value != std::floor(value)) return std::nullopt;
    return static_cast<std::int32_t>(value);
}

class Lists {
   public:
    Lists(const Source& source, const NumberArrays& arrays, FeatureRows& rows)
        : source_(source), names_(arrays_of(rows.words())), arrays_(arrays), rows_(rows) {}

    void take() {
        const auto is_there = [&](CandidateKind kind) { return array_of_pairs(kind).has_value(); };
        if (!rows_.words().has_values() && std::none_of(all_kinds.begin(), all_kinds.end(), is_there))
            fail("there is none of the arrays \"vertex_faces\", \"edge_edges\" and so on");
        for (const CandidateKind kind : all_kinds)
            if (rows_.words().has(kind)) add(kind);
    }

   private:
    [[noreturn]] void fail(const std::string& what) const {
        throw Error(ErrorCode::format, source_.name() + ": " + what);
    }
    /// An array that the file must have.
    const std::vector<double>& need(std::size_t array) const {
        if (!arrays_[array]) fail("there is no array \"" + names_[array].name + "\"");
        return *arrays_[array];
    }
    [[noreturn]] void fail_at(std::size_t array, std::size_t row, const std::string& what) const {
        fail("row " + std::to_string(row) + " of \"" + names_[array].name + "\": " + what);
    }
    std::int32_t index(std::size_t array, std::size_t row, std::size_t column, const char* what) const {
        const std::vector<double>& numbers = *arrays_[array];
        const std::size_t place = names_[array].columns * row + column;
        const auto index = place < numbers.size() ? index_of(numbers[place]) : std::nullopt;
        if (!index) fail_at(array, row, std::string("this is no ") + what);
        return *index;
    }

    const std::optional<std::vector<double>>& array_of_pairs(CandidateKind kind) const {
        return arrays_[arrays_of_a_kind * static_cast<std::size_t>(kind) + pairs];
    }
    /// Lists of candidates have the kinds that were asked for; others may be without rods, particles and pairs of
    /// triangles, or have nothing but these.
    bool may_lack(CandidateKind kind) const {
        const bool of_triangles = array_of_pairs(CandidateKind::face_face).has_value();
        return !rows_.words().has_values() || of_triangles || kind >= CandidateKind::face_face;
    }

    void add(CandidateKind kind) {
        const std::size_t base = arrays_of_a_kind * static_cast<std::size_t>(kind);
        if (may_lack(kind) && !array_of_pairs(kind)) return;
        const std::size_t count = need(base + pairs).size() / 2;
        if ((is_edge(kind, 0) || is_edge(kind, 1)) && count > 0) need(edges);
        const bool has_bodies = arrays_[base + bodies].has_value(), has_values = rows_.words().has_values();
        for (const std::size_t array : {base + bodies, base + values, base + flags}) {
            const bool optional = array != base + values || !has_values;
            if (optional && !arrays_[array]) continue;
            if (need(array).size() != count * names_[array].columns)
                fail("\"" + names_[array].name + "\" is not as long as \"" + names_[base + pairs].name + "\"");
        }
        for (std::size_t i = 0; i < count; ++i) {
            FeatureRow row;
            row.kind = kind;
            if (has_bodies) row.bodies = {index(base + bodies, i, 0, "body"), index(base + bodies, i, 1, "body")};
            take_ids(base, i, 0, row, 0);
            take_ids(base, i, 1, row, first_ids(kind));
            if (has_values) {
                row.value = (*arrays_[base + values])[i];
                row.flag = arrays_[base + flags] ? (*arrays_[base + flags])[i] != 0 : row.value == 0;
            }
            const std::string mistake = rows_.add(row, has_bodies);
            if (!mistake.empty()) fail_at(base + pairs, i, mistake);
        }
    }

    /// Of the feature on one side of row i: `at` is where its ids begin.
    void take_ids(std::size_t base, std::size_t i, std::size_t side, CandidateRow& row, std::size_t at) const {
        if (!is_edge(row.kind, side)) {
            const bool face = feature_of(row.kind, side) == Feature::face;
            row.ids[at] = index(base + pairs, i, side, face ? "face" : "vertex");
            return;
        }
        std::int64_t edge = index(base + pairs, i, side, "edge");
        if (arrays_[first_edge]) {
            const auto& first = *arrays_[first_edge];
            const auto body = static_cast<std::size_t>(side ? row.bodies.second : row.bodies.first);
            if (body + 1 >= first.size()) fail_at(base + bodies, i, "there is no such body");
            edge += index(first_edge, body, 0, "edge");
        }
        if (static_cast<std::size_t>(edge) >= arrays_[edges]->size() / 2)
            fail_at(base + pairs, i, "there is no such edge");
        for (std::size_t end = 0; end < 2; ++end)
            row.ids[at + end] = index(edges, static_cast<std::size_t>(edge), end, "vertex");
    }

    const Source& source_;
    std::vector<ArrayName> names_;
    const NumberArrays& arrays_;
    FeatureRows& rows_;
};

template <class T>
std::vector<double> numbers_from(const std::string& bytes, const NpyHeader& header, std::size_t columns) {
    const std::size_t count = bytes.size() / sizeof(T), rows = count / columns;
    std::vector<double> numbers(count);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t place = header.by_column ? i % columns * rows + i / columns : i;
        numbers[i] = static_cast<double>(load<T>(bytes.data() + place * sizeof(T), header.order));
    }
    return numbers;
}

std::vector<double> read_array(NpzReader::Entry& entry, std::size_t columns) {
    const std::optional<NpyHeader> header = read_npy_header(entry);
    if (!header) entry.fail("is no array of NumPy");
    const auto& shape = header->shape;
    const bool fits =
        columns == 1 ? shape.size() == 1 : shape.size() == 2 && shape[1] == static_cast<std::int64_t>(columns);
    if (!fits || shape[0] > INT64_MAX / 16)
        entry.fail(columns == 1 ? "is not of shape (n,)" : "is not of shape (n, " + std::to_string(columns) + ")");
    const auto take = [&](auto number) {
        using Number = decltype(number);
        const std::size_t count = static_cast<std::size_t>(shape[0]) * columns;
        const std::string bytes = entry.read(count * sizeof(Number));
        if (!entry.at_end()) entry.fail("is longer than its header says");
        return numbers_from<Number>(bytes, *header, columns);
    };
    const std::string& kind = header->kind;
    if (kind == "i4") return take(std::int32_t{});
    if (kind == "u4") return take(std::uint32_t{});
    if (kind == "i8") return take(std::int64_t{});
    if (kind == "u8") return take(std::uint64_t{});
    if (kind == "f4") return take(float{});
    if (kind == "f8") return take(double{});
    if (kind == "u1" || kind == "b1") return take(std::uint8_t{});
    entry.fail("does not hold plain numbers");
}

}  // namespace

std::vector<ArrayName> arrays_of(const FeatureWords& words) {
    std::vector<ArrayName> names;
    for (const CandidateKind kind : all_kinds) {
        const bool kept = words.has(kind), has_values = words.has_values();
        names.push_back({array_of(kind), 2, kept});
        names.push_back({array_of(kind, "bodies"), 2, kept});
        names.push_back({array_of(kind, words.value), 1, kept && has_values});
        names.push_back({array_of(kind, words.flag), 1, kept && has_values});
    }
    names.push_back({"edges", 2, true});
    names.push_back({"first_edge", 1, true});
    return names;
}

void add_rows(const Source& source, const NumberArrays& arrays, FeatureRows& rows) {
    Lists(source, arrays, rows).take();
}

void read_features_npz(const Source& source, FeatureRows& rows) {
    NpzReader archive(source);
    NumberArrays arrays;
    for (const auto& [name, columns, wanted] : arrays_of(rows.words())) {
        if (!wanted) {
            arrays.emplace_back();
            continue;
        }
        NpzReader::Entry entry(archive, name);
        arrays.push_back(entry ? std::optional(read_array(entry, columns)) : std::nullopt);
    }
    add_rows(source, arrays, rows);
}

}  // namespace crumple::io
