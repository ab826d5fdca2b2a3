#include "io/lists/feature_tables.h"

#include <algorithm>
#include <utility>

namespace crumple::io {
namespace {

std::string_view noun_of(Feature feature) {
    return feature == Feature::vertex ? "vertex" : feature == Feature::edge ? "edge" : "face";
}

}  // namespace

std::vector<CandidateKind> FeatureWords::kinds() const {
    std::vector<CandidateKind> kinds(all_kinds.begin(), all_kinds.end());
    if (!has_edge_faces) std::erase(kinds, CandidateKind::edge_face);
    if (!has_face_faces) std::erase(kinds, CandidateKind::face_face);
    return kinds;
}

RowTable FeatureWords::rows() const {
    RowTable table{{"kind", "vertex", "face", "a", "b", "c", "d"}, {}};
    for (const CandidateKind kind : kinds()) {
        ListSection section{in_files(kind).keyword, {}};
        for (std::size_t k = 0; k < id_count(kind); ++k) {
            const Feature feature = feature_of(kind, k < first_ids(kind) ? 0 : 1);
            const std::string_view noun = feature == Feature::face ? "face" : "vertex";
            section.fields.push_back({FieldType::id_of_body, in_files(kind).columns[k], noun});
        }
        if (has_values()) {
            section.fields.push_back({FieldType::number, table.columns.size()});
            section.fields.push_back({FieldType::flag, table.columns.size() + 1, {}, text_has_flag});
        }
        table.sections.push_back(std::move(section));
    }
    if (has_values()) table.columns.insert(table.columns.end(), {std::string(value), std::string(flag)});
    table.may_lack = has_values() ? 1 : 0;
    return table;
}

std::vector<ListArray> FeatureWords::arrays(CandidateKind kind) const {
    const std::string prefix = std::string(candidate_kind_name(kind)) + '_';
    const auto& [first, second] = in_files(kind).features;
    std::vector<ListArray> arrays{
        {std::string(in_files(kind).array), NumberType::int32, 2, {noun_of(first), noun_of(second)}},
        {prefix + "bodies", NumberType::int32, 2, {"body", "body"}}};
    if (has_values()) arrays.push_back({prefix + std::string(value), NumberType::float64});
    if (has_values()) arrays.push_back({prefix + std::string(flag), NumberType::uint8});
    return arrays;
}

void FeatureWords::add(RowWriter& writer, const FeatureRow& row, bool has_bodies) const {
    std::array<ListValue, 6> values;
    const std::size_t ids = id_count(row.kind), first = first_ids(row.kind);
    for (std::size_t k = 0; k < ids; ++k) {
        ListId id{row.ids[k]};
        if (has_bodies) id.body = k < first ? row.bodies.first : row.bodies.second;
        values[k] = id;
    }
    if (has_values()) {
        values[ids] = row.value;
        values[ids + 1] = row.flag;
    }
    const std::size_t section = static_cast<std::size_t>(row.kind) -
                                (!has_edge_faces && row.kind > CandidateKind::edge_face ? 1 : 0) -
                                (!has_face_faces && row.kind > CandidateKind::face_face ? 1 : 0);
    writer.add(section, std::span(values).first(ids + (has_values() ? 2 : 0)));
}

const FeatureWords& words_of(ListKind kind) {
    return kind == ListKind::impacts ? impact_words : kind == ListKind::near ? near_words : candidate_words;
}

ListArray edges_array() { return {"edges", NumberType::int32, 2, {"vertex", "vertex"}}; }
ListArray first_edge_array() { return {"first_edge", NumberType::int64, 1, {"edge"}}; }

void put_in_order(CandidateRow& row) {
    const auto ids = row.ids.begin();
    const std::size_t count = first_ids(row.kind);
    for (const std::size_t side : {0U, 1U}) {
        const auto edge = ids + static_cast<std::ptrdiff_t>(side * count);
        if (is_edge(row.kind, side) && edge[1] < edge[0]) std::swap(edge[0], edge[1]);
    }
    if (feature_of(row.kind, 0) != feature_of(row.kind, 1)) return;
    const auto second = ids + static_cast<std::ptrdiff_t>(count), end = second + static_cast<std::ptrdiff_t>(count);
    auto& [body, other] = row.bodies;
    const bool second_is_less =
        other < body || (other == body && std::lexicographical_compare(second, end, ids, second));
    if (!second_is_less) return;
    std::swap(body, other);
    std::swap_ranges(ids, second, second);
}

}  // namespace crumple::io
