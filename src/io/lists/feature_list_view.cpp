#include "io/lists/feature_list_view.h"

#include <algorithm>
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

bool fits(const FeatureAnswer& answer, CandidateKind kind) {
    const FeatureListView& list = answer[kind];
    const std::size_t count = list.pairs.size(), values = answer.words.has_values() ? count : 0;
    if (count > 0 && !list.listed) return false;
    if (list.values.size() != values || list.flags.size() != values) return false;
    if ((answer.has_bodies() || !list.bodies.empty()) && list.bodies.size() != count) return false;
    for (std::size_t i = 0; i < count; ++i) {
        const BodyPair bodies = answer.bodies_of(kind, i);
        const auto has = [&](std::size_t side, std::int32_t body, std::int32_t index) {
            const Feature feature = feature_of(kind, side);
            if (feature == Feature::edge) return has_edge(answer, body, index);
            return feature == Feature::face || has_point(answer, body, index);
        };
        if (!has(0, bodies.first, list.pairs[i].a) || !has(1, bodies.second, list.pairs[i].b)) return false;
    }
    return true;
}

FeatureAnswer checked(const FeatureAnswer& answer) {
    const bool sound =
        std::all_of(all_kinds.begin(), all_kinds.end(), [&](CandidateKind kind) { return fits(answer, kind); });
    if (!sound)
        throw Error(ErrorCode::invalid_argument,
                    "the lists of " + std::string(answer.words.what) + " do not fit together");
    return answer;
}

FeatureListView view(const ImpactList& list) {
    return {true, span_of(list.pairs), span_of(list.bodies), span_of(list.toi), span_of(list.start)};
}
FeatureListView view(const ProximityList& list) {
    return {true, span_of(list.pairs), span_of(list.bodies), span_of(list.squared_distance), span_of(list.touching)};
}

template <class Answer>
std::array<FeatureListView, candidate_kinds> views(const Answer& answer) {
    std::array<FeatureListView, candidate_kinds> lists;
    for (const FeatureKind kind : all_feature_kinds)
        lists[static_cast<std::size_t>(kind_of(kind))] = view(answer[kind]);
    return lists;
}
std::array<FeatureListView, candidate_kinds> views(const Candidates& answer) {
    std::array<FeatureListView, candidate_kinds> lists;
    for (std::size_t k = 0; k < candidate_kinds; ++k)
        lists[k] = {answer.listed[k], span_of(answer.lists[k].pairs), span_of(answer.lists[k].bodies), {}, {}};
    return lists;
}

std::array<FeatureListView, candidate_kinds> views(const Impacts& answer) {
    auto lists = views<Impacts>(answer);
    FeatureListView& pairs = lists[static_cast<std::size_t>(CandidateKind::face_face)];
    pairs = view(answer.triangle_pairs);
    pairs.listed = answer.lists_triangle_pairs;
    return lists;
}

template <class Answer>
FeatureAnswer view(const FeatureWords& words, const Answer& answer, const FirstImpact* first = nullptr) {
    return checked({words, views(answer), span_of(answer.edges), span_of(answer.first_edge), span_of(answer.points),
                    span_of(answer.first_point), answer.statistics, first});
}

FeatureList as_list(const FeatureAnswer& answer) {
    FeatureList list{{}, answer.has_bodies()};
    for_each_row(answer, [&](const FeatureRow& row) { list.rows.push_back(row); });
    return list;
}

}  // namespace

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

bool FeatureAnswer::lists_edges() const {
    return std::any_of(all_kinds.begin(), all_kinds.end(), [&](CandidateKind kind) {
        return (*this)[kind].listed && (is_edge(kind, 0) || is_edge(kind, 1));
    });
}

BodyPair FeatureAnswer::bodies_of(CandidateKind kind, std::size_t i) const {
    const FeatureListView& list = (*this)[kind];
    return list.bodies.empty() ? BodyPair{0, 0} : list.bodies[i];
}

std::int32_t FeatureAnswer::vertex(std::int32_t body, std::int32_t point) const {
    const auto of_body = points_of(*this, body);
    return of_body.empty() ? point : of_body[static_cast<std::size_t>(point)];
}

Pair FeatureAnswer::by_vertex(CandidateKind kind, Pair pair, const BodyPair& bodies) const {
    if (feature_of(kind, 0) == Feature::vertex) pair.a = vertex(bodies.first, pair.a);
    if (feature_of(kind, 1) == Feature::vertex) pair.b = vertex(bodies.second, pair.b);
    return pair;
}
Pair FeatureAnswer::by_vertex(CandidateKind kind, std::size_t i) const {
    return by_vertex(kind, (*this)[kind].pairs[i], bodies_of(kind, i));
}

FeatureRow FeatureAnswer::row(CandidateKind kind, std::size_t i) const {
    const FeatureListView& list = (*this)[kind];
    FeatureRow row{{kind, bodies_of(kind, i), {}}};
    if (words.has_values()) {
        row.value = list.values[i];
        row.flag = list.flags[i] != 0;
    }
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

FeatureAnswer view(const Impacts& impacts) { return view(impact_words, impacts, &impacts.first); }
FeatureAnswer view_of_triangle_pairs(const Impacts& impacts) {
    FeatureAnswer answer = view(triangle_pair_words, impacts);
    for (const CandidateKind kind : all_kinds)
        if (kind != CandidateKind::face_face) answer.lists[static_cast<std::size_t>(kind)] = {};
    return answer;
}
FeatureAnswer view(const Proximities& nearby) { return view(near_words, nearby); }
FeatureAnswer view(const Candidates& candidates) { return view(candidate_words, candidates); }

FeatureList list_of(const Impacts& impacts) { return as_list(view(impacts)); }
FeatureList list_of(const Proximities& nearby) { return as_list(view(nearby)); }
CandidateRows list_of(const Candidates& candidates) {
    const FeatureAnswer answer = view(candidates);
    CandidateRows list{{}, answer.has_bodies()};
    for_each_row(answer, [&](const CandidateRow& row) { list.rows.push_back(row); });
    return list;
}

}  // namespace crumple::io
