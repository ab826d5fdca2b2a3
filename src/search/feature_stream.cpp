// Answers about features of worlds in blocks: what a backend hands over is placed in its bodies, and gathered until a
// block is full, from world to world.

#include <memory>
#include <type_traits>
#include <utility>

#include "queries/feature_requests.h"
#include "results/feature_output.h"
#include "results/filling_block.h"
#include "results/intersection_output.h"
#include "results/near_details.h"
#include "search/feature_search.h"

namespace crumple {
namespace {

template <class Question>
constexpr bool is_near = std::is_same_v<Question, ProximityQuery>;
template <class Question>
constexpr bool is_candidates = std::is_same_v<Question, CandidateQuery>;

/// The rows of a block, by kind.
template <class Answer>
using Lists = decltype(Answer::lists);

// What a block is handed over as: the answer with these rows.
template <class Answer>
void take_rows(Lists<Answer>& rows, const FeatureBlocks<Answer>& blocks, Answer& answer) {
    std::swap(answer.lists, rows);
    for (const auto& list : answer.lists) answer.count += static_cast<std::int64_t>(list.pairs.size());
    answer.any = true;
    blocks.take(answer);
    std::swap(answer.lists, rows);
}

template <class Answer>
FillingBlock<Lists<Answer>> filling_of(const FeatureBlocks<Answer>& blocks, MemoryMeter& meter, Answer& answer) {
    using Rows = Lists<Answer>;
    const auto make = [&] { return std::make_unique<Rows>(metered_answer<Answer>(&meter).lists); };
    const auto take = [&](Rows& rows) { take_rows(rows, blocks, answer); };
    const auto empty = [](Rows& rows) {
        for (auto& list : rows) clear(list);
    };
    return {blocks.how.block_pairs, {make, {}, take, empty}};
}

}  // namespace

template <class Question, class Answer>
void FeatureSearch::stream(BackendBase& backend, const World& world, const Question& question, bool bodies, bool frugal,
                           const FeatureBlocks<Answer>& blocks, Answer& answer) {
    bodies_ = bodies;
    frugal_ = frugal;
    read(world, question.filter);
    clear(answer);
    answer.statistics.triangles = outline_.triangles();
    if constexpr (is_candidates<Question>)
        for (const CandidateKind kind : question.kinds) answer.listed[static_cast<std::size_t>(kind)] = true;
    answer.first_edge.push_back(0);
    answer.first_point.push_back(0);
    if constexpr (is_near<Question>) near_input_.begin(outline_, question, bodies_, true, backend, buffers_);

    auto filling = filling_of(blocks, meter_, answer);
    constexpr bool step = !is_near<Question>;
    if (in_place(question.filter)) {
        const PreparedScene scene = prepare_in_place(backend, step, question.weld);
        if constexpr (is_near<Question>) near_input_.place(outline_.shape(0));
        answer.edges = features_.edges();
        answer.first_edge.push_back(static_cast<std::int64_t>(answer.edges.size()));
        append_listed_points(0, answer);
        stream_scene(backend, scene, question, true, blocks.how, filling, answer.statistics);
    } else {
        const bool one_world = outline_.worlds() == 1 && own_bodies(1) == 0;
        if (!one_world) list_features(backend, step, question.weld, answer);
        for (std::int32_t pass = 0; pass <= outline_.worlds(); ++pass) {
            cancellation_.check();
            const std::optional<PreparedScene> scene = prepare_pass(backend, pass, step, question.weld);
            if (!scene) continue;
            if constexpr (is_near<Question>) near_input_.place(outline_, scene_);
            if (one_world) append_features(pass, answer);
            stream_scene(backend, *scene, question, false, blocks.how, filling, answer.statistics);
        }
    }
    filling.finish();
    answer.statistics.pairs = answer.count;
}

// Each block tells the edges and points of all worlds, so they have to be there before the first one.
template <class Answer>
void FeatureSearch::list_features(BackendBase& backend, bool step, bool weld, Answer& answer) {
    for (std::int32_t pass = 0; pass <= outline_.worlds(); ++pass) {
        cancellation_.check();
        if (prepare_pass(backend, pass, step, weld)) append_features(pass, answer);
    }
}

template <class Question, class Filling>
void FeatureSearch::stream_scene(BackendBase& backend, const PreparedScene& scene, const Question& question,
                                 bool in_place, const Streaming& how, Filling& filling, Statistics& statistics) {
    auto query = query_of(question, frugal_, features_, rule_);
    Statistics of_scene;
    const auto append_pair = [&](FeatureTypes types, const Pair& found, auto& list) {
        Pair pair = found;
        BodyPair bodies{0, 0};
        if (!in_place) place(types, found, pair, bodies);
        list.pairs.push_back(pair);
        if (bodies_) list.bodies.push_back(bodies);
    };
    if constexpr (is_candidates<Question>) {
        const auto sink = [&](CandidateKind kind, std::span<const Pair> rows) {
            typename Filling::Writer(filling).add(rows.size(), [&](auto& lists, std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i)
                    append_pair(types_of(kind), rows[i], lists[static_cast<std::size_t>(kind)]);
            });
        };
        backend.stream_candidates(scene, query, how, sink, of_scene);
    } else {
        if constexpr (is_near<Question>) near_input_.tell(scene.vertex_count(), backend, cancellation_, query);
        const auto sink = [&](FeatureKind kind, std::span<const FeatureHit> rows) {
            Array<ClosestPoints> closest(&meter_);
            if constexpr (is_near<Question>)
                if (question.closest)
                    find_closest(scene, features_, kind, rows, how.ordered ? &backend : nullptr, closest);
            typename Filling::Writer(filling).add(rows.size(), [&](auto& lists, std::size_t begin, std::size_t end) {
                auto& list = lists[static_cast<std::size_t>(kind)];
                for (std::size_t i = begin; i < end; ++i) {
                    append_pair(types_of(kind), rows[i].pair, list);
                    values(list).push_back(rows[i].value);
                    flags(list).push_back(rows[i].flag);
                    if constexpr (is_near<Question>) {
                        if (closest.empty()) continue;
                        list.type.push_back(closest[i].type);
                        list.at.push_back(closest[i].at);
                    }
                }
            });
        };
        backend.stream(scene, query, how, sink, of_scene);
    }
    add_pass(of_scene, statistics);
}

template void FeatureSearch::stream(BackendBase&, const World&, const ImpactQuery&, bool, bool,
                                    const FeatureBlocks<Impacts>&, Impacts&);
template void FeatureSearch::stream(BackendBase&, const World&, const ProximityQuery&, bool, bool,
                                    const FeatureBlocks<Proximities>&, Proximities&);
template void FeatureSearch::stream(BackendBase&, const World&, const CandidateQuery&, bool, bool,
                                    const FeatureBlocks<Candidates>&, Candidates&);

}  // namespace crumple
