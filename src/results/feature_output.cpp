#include "results/feature_output.h"

#include <tuple>
#include <utility>

namespace crumple {
namespace {

auto arrays(ImpactList& l) {
    return std::tie(l.pairs, l.bodies, l.toi, l.start, l.offsets, l.second_offsets, l.by_second);
}
auto arrays(ProximityList& l) {
    return std::tie(l.pairs, l.bodies, l.squared_distance, l.touching, l.type, l.at, l.offsets, l.second_offsets,
                    l.by_second);
}
auto arrays(CandidateList& l) { return std::tie(l.pairs, l.bodies); }
auto arrays(Impacts& a) {
    return std::tuple_cat(std::tie(a.world_hit, a.world_first, a.edges, a.first_edge, a.points, a.first_point),
                          arrays(a.lists[0]), arrays(a.lists[1]), arrays(a.lists[2]), arrays(a.lists[3]),
                          arrays(a.triangle_pairs));
}
auto arrays(Proximities& a) {
    return std::tuple_cat(std::tie(a.world_hit, a.edges, a.first_edge, a.vertex_distance, a.face_distance,
                                   a.edge_distance, a.points, a.first_point),
                          arrays(a.lists[0]), arrays(a.lists[1]), arrays(a.lists[2]), arrays(a.lists[3]));
}
static_assert(feature_kinds == 4);
auto arrays(Candidates& a) {
    const auto list = [&](CandidateKind kind) { return arrays(a[kind]); };
    return std::tuple_cat(std::tie(a.edges, a.first_edge, a.points, a.first_point), list(CandidateKind::vertex_face),
                          list(CandidateKind::edge_edge), list(CandidateKind::edge_face),
                          list(CandidateKind::face_face), list(CandidateKind::vertex_edge),
                          list(CandidateKind::vertex_vertex));
}
static_assert(candidate_kinds == 6);

template <class Answer, class Visit>
void for_each_array(Answer& answer, Visit visit) {
    std::apply([&](auto&... array) { (visit(array), ...); }, arrays(answer));
}

template <class Arrays>
void clear_each(Arrays& of) {
    for_each_array(of, [](auto& array) { array.clear(); });
}

template <class Answer>
void clear_arrays(Answer& answer) {
    clear_each(answer);
    answer.any = false;
    answer.count = 0;
    answer.statistics = {};
}

template <class Answer>
void swap_arrays(Answer& mine, Answer& theirs) {
    auto to = arrays(theirs);
    std::apply([&](auto&... from) { std::apply([&](auto&... other) { (from.swap_elements(other), ...); }, to); },
               arrays(mine));
    theirs.any = mine.any;
    theirs.count = mine.count;
    theirs.statistics = mine.statistics;
}

// Pairs are sorted by first feature, so counting them gives its offsets. A stable counting sort gives the order by
// second feature.
template <class List>
void index_list(List& list, std::int64_t firsts, std::int64_t seconds, Cancellation& cancellation) {
    list.offsets.assign(static_cast<std::size_t>(firsts) + 1, 0);
    list.second_offsets.assign(static_cast<std::size_t>(seconds) + 2, 0);
    list.by_second.resize_discard(list.pairs.size());
    for_each_checked(list.pairs.size(), cancellation, [&](std::size_t i) {
        ++list.offsets[list.pairs[i].a + 1];
        ++list.second_offsets[list.pairs[i].b + 2];
    });
    for (std::int64_t i = 0; i < firsts; ++i) list.offsets[i + 1] += list.offsets[i];
    std::int64_t* next = list.second_offsets.data() + 1;
    for (std::int64_t i = 0; i < seconds; ++i) next[i + 1] += next[i];
    for_each_checked(list.pairs.size(), cancellation,
                     [&](std::size_t i) { list.by_second[next[list.pairs[i].b]++] = static_cast<std::int64_t>(i); });
    list.second_offsets.resize(static_cast<std::size_t>(seconds) + 1);
}

}  // namespace

template <class Answer>
Answer metered_result(MemoryMeter* meter) {
    Answer answer;
    for_each_array(answer, [&](auto& array) { array = std::decay_t<decltype(array)>(meter); });
    return answer;
}
template Impacts metered_result(MemoryMeter*);
template Proximities metered_result(MemoryMeter*);
template Candidates metered_result(MemoryMeter*);

Impacts metered_impacts(MemoryMeter* meter) { return metered_result<Impacts>(meter); }
Proximities metered_nearby(MemoryMeter* meter) { return metered_result<Proximities>(meter); }
Candidates metered_candidates(MemoryMeter* meter) { return metered_result<Candidates>(meter); }

void clear(Impacts& answer) {
    clear_arrays(answer);
    answer.first = {};
    answer.lists_triangle_pairs = false;
}
void clear(Proximities& answer) { clear_arrays(answer); }
void clear(Candidates& answer) {
    clear_arrays(answer);
    answer.listed = {};
}

void clear(ImpactList& list) { clear_each(list); }
void clear(ProximityList& list) { clear_each(list); }
void clear(CandidateList& list) { clear_each(list); }

void swap_out(Impacts& mine, Impacts& theirs) {
    swap_arrays(mine, theirs);
    theirs.first = mine.first;
    theirs.lists_triangle_pairs = mine.lists_triangle_pairs;
    clear(mine);
}
void swap_out(Proximities& mine, Proximities& theirs) {
    swap_arrays(mine, theirs);
    clear(mine);
}

void swap_out(Candidates& mine, Candidates& theirs) {
    swap_arrays(mine, theirs);
    theirs.listed = mine.listed;
    clear(mine);
}

void make_index(ImpactList& list, std::int64_t firsts, std::int64_t seconds, Cancellation& cancellation) {
    index_list(list, firsts, seconds, cancellation);
}
void make_index(ProximityList& list, std::int64_t firsts, std::int64_t seconds, Cancellation& cancellation) {
    index_list(list, firsts, seconds, cancellation);
}

}  // namespace crumple
