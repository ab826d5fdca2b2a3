#include "io/feature_answer.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "crumple/error.h"

namespace crumple::io {

namespace {

template <class T>
std::span<const T> span_of(const Array<T>& array) {
    return {array.data(), array.size()};
}

/// Whether an edge of the answer has this number, in its body.
bool has_edge(const FeatureAnswer& answer, std::int32_t body, std::int32_t edge) {
    const auto b = static_cast<std::size_t>(body);
    if (body < 0 || edge < 0 || b + 1 >= answer.first_edge.size()) return false;
    const std::int64_t begin = answer.first_edge[b], end = answer.first_edge[b + 1];
    return begin >= 0 && edge < end - begin && end <= static_cast<std::int64_t>(answer.edges.size());
}

/// The points that a body lists; none: they are its vertices.
std::span<const std::int32_t> points_of(const FeatureAnswer& answer, std::int32_t body) {
    const auto b = static_cast<std::size_t>(body);
    if (body < 0 || b + 1 >= answer.first_point.size()) return {};
    const std::int64_t begin = answer.first_point[b], end = answer.first_point[b + 1];
    if (begin < 0 || begin > end || end > static_cast<std::int64_t>(answer.points.size())) return {};
    return answer.points.subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin));
}
bool has_point(const FeatureAnswer& answer, std::int32_t body, std::int32_t point) {
    const auto points = points_of(answer, body);
    return points.empty() || (point >= 0 && static_cast<std::size_t>(point) < points.size());
}

bool fits(const FeatureAnswer& answer, FeatureKind kind) {
    const FeatureListView& list = answer.lists[static_cast<std::size_t>(kind)];
    const std::size_t count = list.pairs.size();
    if (list.values.size() != count || list.flags.size() != count) return false;
    if ((answer.has_bodies() || !list.bodies.empty()) && list.bodies.size() != count) return false;
    for (std::size_t i = 0; i < count; ++i) {
        const BodyPair bodies = answer.bodies_of(kind, i);
        const auto has = [&](std::size_t side, std::int32_t body, std::int32_t index) {
            if (is_edge(kind, side)) return has_edge(answer, body, index);
            return (kind == FeatureKind::vertex_face && side == 1) || has_point(answer, body, index);
        };
        if (!has(0, bodies.first, list.pairs[i].a) || !has(1, bodies.second, list.pairs[i].b)) return false;
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

template <class Answer>
std::array<FeatureListView, feature_kinds> views(const Answer& answer) {
    std::array<FeatureListView, feature_kinds> lists;
    for (std::size_t k = 0; k < feature_kinds; ++k) lists[k] = view(answer.lists[k]);
    return lists;
}

FeatureList as_list(const FeatureAnswer& answer) {
    FeatureList list{{}, answer.has_bodies()};
    for (const FeatureKind kind : all_feature_kinds)
        for (std::size_t i = 0; i < answer.lists[static_cast<std::size_t>(kind)].pairs.size(); ++i)
            list.rows.push_back(answer.row(kind, i));
    return list;
}

}  // namespace

void put_in_order(FeatureRow& row) {
    auto& [a, b, c, d] = row.ids;
    if (row.kind == FeatureKind::edge_edge) {
        if (a > b) std::swap(a, b);
        if (c > d) std::swap(c, d);
        if (std::tuple(row.bodies.second, c, d) < std::tuple(row.bodies.first, a, b)) {
            std::swap(row.bodies.first, row.bodies.second);
            std::swap(a, c);
            std::swap(b, d);
        }
    }
    if (row.kind == FeatureKind::vertex_edge && b > c) std::swap(b, c);
    if (row.kind == FeatureKind::vertex_vertex && std::pair(row.bodies.second, b) < std::pair(row.bodies.first, a)) {
        std::swap(row.bodies.first, row.bodies.second);
        std::swap(a, b);
    }
}

BodyPair FeatureAnswer::bodies_of(FeatureKind kind, std::size_t i) const {
    const FeatureListView& list = lists[static_cast<std::size_t>(kind)];
    return list.bodies.empty() ? BodyPair{0, 0} : list.bodies[i];
}

std::int32_t FeatureAnswer::vertex(std::int32_t body, std::int32_t point) const {
    const auto of_body = points_of(*this, body);
    return of_body.empty() ? point : of_body[static_cast<std::size_t>(point)];
}

Pair FeatureAnswer::by_vertex(FeatureKind kind, Pair pair, const BodyPair& bodies) const {
    if (kind != FeatureKind::edge_edge) pair.a = vertex(bodies.first, pair.a);
    if (kind == FeatureKind::vertex_vertex) pair.b = vertex(bodies.second, pair.b);
    return pair;
}
Pair FeatureAnswer::by_vertex(FeatureKind kind, std::size_t i) const {
    return by_vertex(kind, lists[static_cast<std::size_t>(kind)].pairs[i], bodies_of(kind, i));
}

FeatureRow FeatureAnswer::row(FeatureKind kind, std::size_t i) const {
    const FeatureListView& list = lists[static_cast<std::size_t>(kind)];
    FeatureRow row{kind, bodies_of(kind, i), {}, list.values[i], list.flags[i] != 0};
    const Pair pair = by_vertex(kind, i);
    std::size_t ids = 0;
    const auto add = [&](std::size_t side, std::int32_t body, std::int32_t index) {
        if (!is_edge(kind, side)) {
            row.ids[ids++] = index;
            return;
        }
        const Edge e = edges[static_cast<std::size_t>(first_edge[static_cast<std::size_t>(body)] + index)];
        row.ids[ids++] = e.a;
        row.ids[ids++] = e.b;
    };
    add(0, row.bodies.first, pair.a);
    add(1, row.bodies.second, pair.b);
    put_in_order(row);
    return row;
}

FeatureAnswer view(const Impacts& impacts) {
    return checked({impact_words, views(impacts), span_of(impacts.edges), span_of(impacts.first_edge),
                    span_of(impacts.points), span_of(impacts.first_point), impacts.statistics, &impacts.first});
}
FeatureAnswer view(const Nearby& nearby) {
    return checked({near_words, views(nearby), span_of(nearby.edges), span_of(nearby.first_edge),
                    span_of(nearby.points), span_of(nearby.first_point), nearby.statistics});
}

FeatureList list_of(const Impacts& impacts) { return as_list(view(impacts)); }
FeatureList list_of(const Nearby& nearby) { return as_list(view(nearby)); }

}  // namespace crumple::io
