// Converts impacts, near pairs and candidates to tables and to lists of rows.

#include <algorithm>

#include "crumple/error.h"
#include "io/bytes/json.h"
#include "io/lists/feature_tables.h"

namespace crumple::io {
namespace {

/// Pairs of one kind.
struct PairsOfKind {
    bool listed = false;  ///< true if the result has this kind: its arrays are then written even if they are empty
    std::span<const Pair> pairs;
    std::span<const BodyPair> bodies;
    std::span<const double> values;
    std::span<const std::uint8_t> flags;
};

/// Common view of a result: impacts, near pairs or candidates.
struct FeatureLists {
    FeatureWords words;
    std::array<PairsOfKind, candidate_kinds> lists;  ///< pairs of each CandidateKind
    std::span<const Edge> edges;
    std::span<const std::int64_t> first_edge;
    std::span<const std::int32_t> points;  ///< vertices of codimensional (listed) points: Impacts::points
    std::span<const std::int64_t> first_point;
    const Statistics* statistics;
    const FirstImpact* first = nullptr;  ///< null unless these are impacts

    PairsOfKind& operator[](CandidateKind kind) { return lists[static_cast<std::size_t>(kind)]; }
    const PairsOfKind& operator[](CandidateKind kind) const { return lists[static_cast<std::size_t>(kind)]; }
    bool has_bodies() const { return first_edge.size() > 2; }

    bool lists_edges() const {
        return std::any_of(all_kinds.begin(), all_kinds.end(), [&](CandidateKind kind) {
            return (*this)[kind].listed && (is_edge(kind, 0) || is_edge(kind, 1));
        });
    }
    BodyPair bodies_of(CandidateKind kind, std::size_t i) const {
        const PairsOfKind& list = (*this)[kind];
        return list.bodies.empty() ? BodyPair{0, 0} : list.bodies[i];
    }
    std::span<const Edge> edges_of(std::int32_t body) const { return piece(edges, first_edge, body); }
    /// Returns, for each codimensional point of a body, the index of its vertex; empty if point i is vertex i.
    std::span<const std::int32_t> points_of(std::int32_t body) const { return piece(points, first_point, body); }

    /// Returns a pair, with the indices of codimensional points replaced by the indices of their vertices.
    Pair by_vertex(CandidateKind kind, Pair pair, const BodyPair& bodies) const {
        const auto name_vertex = [&](std::size_t side, std::int32_t body, std::int32_t& id) {
            const auto of_body = points_of(body);
            if (feature_of(kind, side) == Feature::vertex && !of_body.empty())
                id = of_body[static_cast<std::size_t>(id)];
        };
        name_vertex(0, bodies.first, pair.a);
        name_vertex(1, bodies.second, pair.b);
        return pair;
    }
    Pair by_vertex(CandidateKind kind, std::size_t i) const {
        return by_vertex(kind, (*this)[kind].pairs[i], bodies_of(kind, i));
    }

    FeatureRow row(CandidateKind kind, std::size_t i) const {
        const PairsOfKind& list = (*this)[kind];
        FeatureRow row{{kind, bodies_of(kind, i), {}}};
        if (words.has_values()) {
            row.value = list.values[i];
            row.flag = list.flags[i] != 0;
        }
        auto id = row.ids.begin();
        const auto add = [&](std::size_t side, std::int32_t body, std::int32_t index) {
            if (!is_edge(kind, side)) {
                *id++ = index;
                return;
            }
            const Edge edge = edges_of(body)[static_cast<std::size_t>(index)];
            *id++ = edge.a;
            *id++ = edge.b;
        };
        const Pair pair = by_vertex(kind, i);
        add(0, row.bodies.first, pair.a);
        add(1, row.bodies.second, pair.b);
        put_in_order(row);
        return row;
    }

    /// Calls use(row) for all rows, in the order of the result. In rows of candidates, ignore value and flag.
    template <class Use>
    void for_each_row(Use use) const {
        for (const CandidateKind kind : all_kinds)
            for (std::size_t i = 0; i < (*this)[kind].pairs.size(); ++i) use(row(kind, i));
    }

   private:
    /// Returns a body's part of an array: the items from first[body] to first[body + 1]. Empty if there is no such body
    /// or if these bounds are not valid.
    template <class T>
    static std::span<const T> piece(std::span<const T> all, std::span<const std::int64_t> first, std::int32_t body) {
        const auto b = static_cast<std::size_t>(body);
        if (body < 0 || b + 1 >= first.size()) return {};
        const std::int64_t begin = first[b], end = first[b + 1];
        if (begin < 0 || begin > end || end > static_cast<std::int64_t>(all.size())) return {};
        return all.subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin));
    }
};

bool has_feature(const FeatureLists& lists, Feature feature, std::int32_t body, std::int32_t index) {
    if (feature == Feature::face) return true;
    const std::size_t edges = lists.edges_of(body).size(), points = lists.points_of(body).size();
    if (feature == Feature::vertex && points == 0) return true;
    return index >= 0 && static_cast<std::size_t>(index) < (feature == Feature::edge ? edges : points);
}

bool fit_together(const FeatureLists& lists, CandidateKind kind) {
    const PairsOfKind& list = lists[kind];
    const std::size_t count = list.pairs.size(), values = lists.words.has_values() ? count : 0;
    if (count > 0 && !list.listed) return false;
    if (list.values.size() != values || list.flags.size() != values) return false;
    if ((lists.has_bodies() || !list.bodies.empty()) && list.bodies.size() != count) return false;
    for (std::size_t i = 0; i < count; ++i) {
        const BodyPair bodies = lists.bodies_of(kind, i);
        if (!has_feature(lists, feature_of(kind, 0), bodies.first, list.pairs[i].a) ||
            !has_feature(lists, feature_of(kind, 1), bodies.second, list.pairs[i].b))
            return false;
    }
    return true;
}

PairsOfKind pairs_of(const ImpactList& list, bool listed = true) {
    return {listed, list.pairs.span(), list.bodies.span(), list.toi.span(), list.start.span()};
}
PairsOfKind pairs_of(const ProximityList& list) {
    return {true, list.pairs.span(), list.bodies.span(), list.squared_distance.span(), list.touching.span()};
}

template <class Result>
FeatureLists lists_of(const FeatureWords& words, const Result& result, const FirstImpact* first = nullptr) {
    FeatureLists lists{words,
                       {},
                       result.edges.span(),
                       result.first_edge.span(),
                       result.points.span(),
                       result.first_point.span(),
                       &result.statistics,
                       first};
    if constexpr (requires { result.listed; }) {
        for (const CandidateKind kind : all_kinds) {
            const CandidateList& list = result[kind];
            lists[kind] = {
                result.listed[static_cast<std::size_t>(kind)], list.pairs.span(), list.bodies.span(), {}, {}};
        }
    } else {
        for (const FeatureKind kind : all_feature_kinds) lists[kind_of(kind)] = pairs_of(result[kind]);
    }
    if constexpr (requires { result.triangle_pairs; })
        lists[CandidateKind::face_face] = pairs_of(result.triangle_pairs, result.lists_triangle_pairs);
    for (const CandidateKind kind : all_kinds)
        if (!fit_together(lists, kind))
            throw Error(ErrorCode::invalid_argument,
                        "the lists of " + std::string(words.what) + " do not fit together");
    return lists;
}
FeatureLists lists_of(const Impacts& impacts) { return lists_of(impact_words, impacts, &impacts.first); }
FeatureLists lists_of(const Proximities& nearby) { return lists_of(near_words, nearby); }
FeatureLists lists_of(const Candidates& candidates) { return lists_of(candidate_words, candidates); }

template <class List>
List rows_of(const FeatureLists& lists) {
    List list{{}, lists.has_bodies()};
    lists.for_each_row([&](const FeatureRow& row) { list.rows.push_back(row); });
    return list;
}

void add_earliest(Sink& sink, const FeatureLists& lists) {
    const FirstImpact& first = *lists.first;
    if (!first.found) {
        sink << "null";
        return;
    }
    const Pair pair = lists.by_vertex(kind_of(first.kind), first.pair, first.bodies);
    sink << R"({"kind":")" << feature_kind_name(first.kind) << R"(","pair":[)" << pair.a << ',' << pair.b << ']';
    if (lists.has_bodies()) sink << R"(,"bodies":[)" << first.bodies.first << ',' << first.bodies.second << ']';
    sink << R"(,"toi":)" << first.toi << R"(,"start":)" << int{first.start} << '}';
}

/// Returns the array of pairs, with the indices of codimensional points replaced by the indices of their vertices.
ListMember pairs_by_vertex(const FeatureLists& lists, CandidateKind kind, ListArray array) {
    const std::span<const Pair> pairs = lists[kind].pairs;
    if (lists.points.empty()) return with_rows(std::move(array), pairs);
    const auto own = std::make_shared<std::vector<Pair>>();
    for (std::size_t i = 0; i < pairs.size(); ++i) own->push_back(lists.by_vertex(kind, i));
    ListMember member = with_rows(std::move(array), std::span<const Pair>(*own));
    member.owner = own;
    return member;
}

std::vector<ListMember> members_of_features(const FeatureLists& lists) {
    std::vector<ListMember> members;
    for (const CandidateKind kind : lists.words.kinds()) {
        if (kind == CandidateKind::edge_edge && lists.lists_edges()) {
            members.push_back(with_rows(edges_array(), lists.edges));
            if (lists.has_bodies()) members.push_back(with_rows(first_edge_array(), lists.first_edge));
        }
        const PairsOfKind& list = lists[kind];
        if (!list.listed) continue;
        const std::vector<ListArray> arrays = lists.words.arrays(kind);
        members.push_back(pairs_by_vertex(lists, kind, arrays[0]));
        if (lists.has_bodies()) members.push_back(with_rows(arrays[1], list.bodies));
        if (!lists.words.has_values()) continue;
        members.push_back(with_rows(arrays[2], list.values));
        members.push_back(with_rows(arrays[3], list.flags));
    }
    if (lists.first) members.push_back(json_member("earliest", [&](Sink& sink) { add_earliest(sink, lists); }));
    members.push_back(json_member("statistics", [&](Sink& sink) { sink << json_of(*lists.statistics); }));
    return members;
}

ListTable table_of_lists(FeatureLists lists) {
    const auto own = std::make_shared<const FeatureLists>(lists);
    return {own->words.what, own->words.rows(),
            [own](RowWriter& writer) {
                own->for_each_row([&](const FeatureRow& row) { own->words.add(writer, row, own->has_bodies()); });
            },
            [own] { return members_of_features(*own); }};
}

}  // namespace

ListTable table_of(const Impacts& impacts) { return table_of_lists(lists_of(impacts)); }
ListTable table_of(const Proximities& nearby) { return table_of_lists(lists_of(nearby)); }
ListTable table_of(const Candidates& candidates) { return table_of_lists(lists_of(candidates)); }
ListTable table_of_triangle_pairs(const Impacts& impacts) {
    FeatureLists lists = lists_of(triangle_pair_words, impacts);
    for (const FeatureKind kind : all_feature_kinds) lists[kind_of(kind)] = {};
    return table_of_lists(lists);
}

FeatureList list_of(const Impacts& impacts) { return rows_of<FeatureList>(lists_of(impacts)); }
FeatureList list_of(const Proximities& nearby) { return rows_of<FeatureList>(lists_of(nearby)); }
CandidateRows list_of(const Candidates& candidates) { return rows_of<CandidateRows>(lists_of(candidates)); }

}  // namespace crumple::io
