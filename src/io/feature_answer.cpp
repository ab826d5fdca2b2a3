#include "io/feature_answer.h"

#include <algorithm>

#include "crumple/error.h"

namespace crumple::io {

namespace {

template <class T>
std::span<const T> span_of(const Array<T>& array) {
    return {array.data(), array.size()};
}

/// Whether an edge of the answer has this number, in its body.
bool is_edge(const FeatureAnswer& answer, std::int32_t body, std::int32_t edge) {
    const auto b = static_cast<std::size_t>(body);
    if (body < 0 || edge < 0 || b + 1 >= answer.first_edge.size()) return false;
    const std::int64_t begin = answer.first_edge[b], end = answer.first_edge[b + 1];
    return begin >= 0 && edge < end - begin && end <= static_cast<std::int64_t>(answer.edges.size());
}

bool fits(const FeatureAnswer& answer, FeatureKind kind) {
    const FeatureListView& list = answer.lists[static_cast<std::size_t>(kind)];
    const std::size_t count = list.pairs.size();
    if (list.values.size() != count || list.flags.size() != count) return false;
    if ((answer.has_bodies() || !list.bodies.empty()) && list.bodies.size() != count) return false;
    if (kind == FeatureKind::vertex_face) return true;
    for (std::size_t i = 0; i < count; ++i) {
        const BodyPair bodies = list.bodies.empty() ? BodyPair{0, 0} : list.bodies[i];
        if (!is_edge(answer, bodies.first, list.pairs[i].a) || !is_edge(answer, bodies.second, list.pairs[i].b))
            return false;
    }
    return true;
}

FeatureAnswer checked(const FeatureAnswer& answer) {
    const bool sound = std::all_of(all_feature_kinds.begin(), all_feature_kinds.end(),
                                   [&](FeatureKind kind) { return fits(answer, kind); });
    if (!sound)
        throw Error(ErrorCode::invalid_argument,
                    "the lists of " + std::string(answer.words.what) + " do not fit together");
    return answer;
}

FeatureListView view(const ImpactList& list) {
    return {span_of(list.pairs), span_of(list.bodies), span_of(list.toi), span_of(list.start)};
}
FeatureListView view(const NearList& list) {
    return {span_of(list.pairs), span_of(list.bodies), span_of(list.squared_distance), span_of(list.touching)};
}

FeatureList as_list(const FeatureAnswer& answer) {
    FeatureList list{{}, answer.has_bodies()};
    for (const FeatureKind kind : all_feature_kinds)
        for (std::size_t i = 0; i < answer.lists[static_cast<std::size_t>(kind)].pairs.size(); ++i)
            list.rows.push_back(answer.row(kind, i));
    return list;
}

}  // namespace

FeatureRow FeatureAnswer::row(FeatureKind kind, std::size_t i) const {
    const FeatureListView& list = lists[static_cast<std::size_t>(kind)];
    FeatureRow row{kind, {0, 0}, {list.pairs[i].a, list.pairs[i].b, 0, 0}, list.values[i], list.flags[i] != 0};
    if (!list.bodies.empty()) row.bodies = list.bodies[i];
    if (kind == FeatureKind::vertex_face) return row;
    const auto edge = [&](std::int32_t body, std::int32_t index) {
        return edges[static_cast<std::size_t>(first_edge[static_cast<std::size_t>(body)] + index)];
    };
    const Edge first = edge(row.bodies.first, list.pairs[i].a), second = edge(row.bodies.second, list.pairs[i].b);
    row.ids = {first.a, first.b, second.a, second.b};
    return row;
}

FeatureAnswer view(const Impacts& impacts) {
    return checked({impact_words,
                    {view(impacts.vertex_faces()), view(impacts.edge_edges())},
                    span_of(impacts.edges),
                    span_of(impacts.first_edge),
                    impacts.statistics,
                    &impacts.first});
}
FeatureAnswer view(const Nearby& nearby) {
    return checked({near_words,
                    {view(nearby.vertex_faces()), view(nearby.edge_edges())},
                    span_of(nearby.edges),
                    span_of(nearby.first_edge),
                    nearby.statistics});
}

FeatureList list_of(const Impacts& impacts) { return as_list(view(impacts)); }
FeatureList list_of(const Nearby& nearby) { return as_list(view(nearby)); }

}  // namespace crumple::io
