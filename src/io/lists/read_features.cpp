// Reads lists of impacts, near pairs and candidates.

#include <algorithm>

#include "io/lists/feature_tables.h"

namespace crumple::io {
namespace {

/// Returns what is wrong with the value of a row, or an empty text.
std::string check_value(const FeatureRow& row, const FeatureWords& words) {
    const bool motion = words.value == impact_words.value;
    if (motion && !(row.value >= 0 && row.value <= 1)) return "a time of contact must lie in [0, 1]";
    if (!(row.value >= 0)) return "a squared distance must be 0 or more";
    if (row.flag && row.value != 0)
        return "a row with " + std::string(words.flag) + " 1 must have " + std::string(words.value) + " 0";
    return {};
}

/// Reader of one list of impacts, near pairs or candidates.
template <class List>
class FeatureReader {
   public:
    FeatureReader(const Source& source, const FeatureWords& words)
        : source_(source), words_(words), kinds_(words.kinds()) {}

    List read() {
        std::vector<ListArray> arrays{edges_array(), first_edge_array()};
        for (const CandidateKind kind : kinds_)
            for (ListArray& array : words_.arrays(kind)) arrays.push_back(std::move(array));
        read_list(source_,
                  {words_.rows(),
                   [&](std::size_t section, std::span<const ListValue> values) { return add(kinds_[section], values); },
                   arrays, [&](const NumbersByName& numbers) { add(numbers); }});
        return std::move(list_);
    }

   private:
    /// Adds the row that consists of these values. If it is not valid, returns what is wrong with it.
    std::string add(CandidateKind kind, std::span<const ListValue> values) {
        FeatureRow row;
        row.kind = kind;
        const std::size_t first = first_ids(kind), ids = id_count(kind);
        for (std::size_t k = 0; k < ids; ++k) {
            const ListId id = std::get<ListId>(values[k]);
            const bool ends_edge = k != 0 && k != first;
            std::int32_t& body = k < first ? row.bodies.first : row.bodies.second;
            if ((k > 0 || !list_.rows.empty()) && id.body.has_value() != list_.has_bodies)
                return "some ids have the number of a file and some do not";
            list_.has_bodies = id.body.has_value();
            if (ends_edge && body != id.body.value_or(0)) return "an edge has vertices of two files";
            if (ends_edge && row.ids[k - 1] == id.index) return "an edge names a vertex twice";
            body = id.body.value_or(0);
            row.ids[k] = id.index;
        }
        if (words_.has_values()) {
            row.value = std::get<double>(values[ids]);
            row.flag = ids + 1 < values.size() ? std::get<bool>(values[ids + 1]) : row.value == 0;
            if (std::string mistake = check_value(row, words_); !mistake.empty()) return mistake;
        }
        put_in_order(row);
        list_.rows.push_back(row);
        return {};
    }

    void add(const NumbersByName& numbers) {
        const auto has = [&](CandidateKind kind) { return find(numbers, in_files(kind).array) != nullptr; };
        if (!words_.has_values() && std::none_of(kinds_.begin(), kinds_.end(), has))
            fail("it has none of the arrays \"vertex_faces\", \"edge_edges\" and so on");
        for (const CandidateKind kind : kinds_) {
            // Some kinds may have no arrays in the file. Lists of candidates have only the requested kinds. Lists of
            // impacts and near pairs may lack pairs of a vertex with an edge or a vertex, which occur only in meshes
            // with lists of edges or points (MeshView::edges, MeshView::points). Lists of impacts may also lack pairs
            // of triangles, or have no other pairs.
            const bool may_lack =
                !words_.has_values() || has(CandidateKind::face_face) || kind >= CandidateKind::face_face;
            if (!may_lack || has(kind)) add(numbers, kind);
        }
    }

    void add(const NumbersByName& numbers, CandidateKind kind) {
        const std::vector<ListArray> arrays = words_.arrays(kind);
        std::array<const ArrayNumbers*, 4> columns{};  // bodies and flags may be missing
        for (std::size_t i = 0; i < arrays.size(); ++i)
            columns[i] = i % 2 == 0 ? &need(numbers, arrays[i].name) : find(numbers, arrays[i].name);
        const auto [pairs, bodies, numbers_of_rows, flags] = columns;
        const std::size_t rows = pairs->ids.size() / 2;
        for (std::size_t i = 0; i < arrays.size(); ++i)
            if (columns[i] && columns[i]->ids.size() + columns[i]->numbers.size() != rows * arrays[i].width)
                fail("\"" + arrays[i].name + "\" is not as long as \"" + arrays[0].name + "\"");

        if (rows > 0 && (is_edge(kind, 0) || is_edge(kind, 1))) edges_ = &need(numbers, edges_array().name);
        first_edge_ = find(numbers, first_edge_array().name);

        std::vector<ListValue> values;
        for (std::size_t row = 0; row < rows; ++row) {
            values.clear();
            for (const std::size_t side : {0U, 1U}) {
                ListId id{pairs->ids[2 * row + side]};
                if (bodies) id.body = bodies->ids[2 * row + side];
                if (!is_edge(kind, side)) {
                    values.emplace_back(id);
                    continue;
                }
                for (const std::int32_t vertex : ends_of_edge(id, arrays, row))
                    values.emplace_back(ListId{vertex, id.body});
            }
            if (numbers_of_rows) values.emplace_back(numbers_of_rows->numbers[row]);
            if (flags) values.emplace_back(flags->numbers[row] != 0);
            const std::string mistake = add(kind, values);
            if (!mistake.empty()) fail_at(arrays[0], row, mistake);
        }
    }

    /// Returns the vertices of edge `id`, which row `row` of `arrays` names.
    std::array<std::int32_t, 2> ends_of_edge(const ListId& id, const std::vector<ListArray>& arrays,
                                             std::size_t row) const {
        auto edge = static_cast<std::size_t>(id.index);
        if (first_edge_) {
            const auto body = static_cast<std::size_t>(id.body.value_or(0));
            if (body + 1 >= first_edge_->ids.size()) fail_at(arrays[1], row, "there is no such body");
            edge += static_cast<std::size_t>(first_edge_->ids[body]);
        }
        if (edge >= edges_->ids.size() / 2) fail_at(arrays[0], row, "there is no such edge");
        return {edges_->ids[2 * edge], edges_->ids[2 * edge + 1]};
    }

    static const ArrayNumbers* find(const NumbersByName& numbers, std::string_view name) {
        const auto found = numbers.find(name);
        return found == numbers.end() ? nullptr : &found->second;
    }
    const ArrayNumbers& need(const NumbersByName& numbers, std::string_view name) const {
        if (const ArrayNumbers* const found = find(numbers, name)) return *found;
        fail("there is no array \"" + std::string(name) + "\"");
    }
    [[noreturn]] void fail(const std::string& what) const {
        throw Error(ErrorCode::format, source_.name() + ": " + what);
    }
    [[noreturn]] void fail_at(const ListArray& array, std::size_t row, const std::string& what) const {
        fail(row_name(array, row) + ": " + what);
    }

    const Source& source_;
    const FeatureWords& words_;
    std::vector<CandidateKind> kinds_;
    const ArrayNumbers *edges_ = nullptr, *first_edge_ = nullptr;
    List list_;
};

}  // namespace

FeatureList read_impacts(const std::filesystem::path& path) {
    return FeatureReader<FeatureList>(Source(path), impact_words).read();
}
FeatureList read_impacts(std::istream& in, const std::string& name) {
    return FeatureReader<FeatureList>(Source(in, name), impact_words).read();
}

FeatureList read_near(const std::filesystem::path& path) {
    return FeatureReader<FeatureList>(Source(path), near_words).read();
}
FeatureList read_near(std::istream& in, const std::string& name) {
    return FeatureReader<FeatureList>(Source(in, name), near_words).read();
}

CandidateRows read_candidates(const std::filesystem::path& path) {
    return FeatureReader<CandidateRows>(Source(path), candidate_words).read();
}
CandidateRows read_candidates(std::istream& in, const std::string& name) {
    return FeatureReader<CandidateRows>(Source(in, name), candidate_words).read();
}

}  // namespace crumple::io
