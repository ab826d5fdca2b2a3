// Answers about features of worlds in blocks: what a backend hands over is placed in its bodies, and gathered until a
// block is full, from world to world.

#include <algorithm>
#include <memory>
#include <tuple>
#include <type_traits>
#include <utility>

#include "queries/feature_requests.h"
#include "results/feature_output.h"
#include "results/intersection_output.h"
#include "results/near_details.h"
#include "results/ordered_blocks.h"
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

/// The rows of a list, without offsets.
auto rows_of(ImpactList& l) { return std::tie(l.pairs, l.bodies, l.toi, l.start); }
auto rows_of(ProximityList& l) { return std::tie(l.pairs, l.bodies, l.squared_distance, l.touching, l.type, l.at); }
auto rows_of(CandidateList& l) { return std::tie(l.pairs, l.bodies); }

template <class Rows>
std::size_t size_of(const Rows& lists) {
    std::size_t rows = 0;
    for (const auto& list : lists) rows += list.pairs.size();
    return rows;
}

template <class Element>
void append(Array<Element>& to, const Array<Element>& from, std::size_t begin, std::size_t end) {
    if (from.empty()) return;
    to.make_room_for(end - begin);
    for (std::size_t i = begin; i < end; ++i) to.push_back(from[i]);
}

// Rows count through all lists, one behind the other.
template <class Rows>
void append_rows(Rows& to, Rows& piece, std::size_t begin, std::size_t end) {
    std::size_t first = 0;
    for (std::size_t k = 0; k < to.size(); ++k) {
        const std::size_t rows = piece[k].pairs.size();
        const std::size_t from = std::clamp(begin, first, first + rows) - first,
                          until = std::clamp(end, first, first + rows) - first;
        first += rows;
        if (from == until) continue;
        auto target = rows_of(to[k]), source = rows_of(piece[k]);
        std::apply(
            [&](auto&... array) {
                std::apply([&](auto&... added) { (append(array, added, from, until), ...); }, source);
            },
            target);
    }
}

// Delivers a block as a result that has these rows.
template <class Answer>
void take_rows(Lists<Answer>& rows, const FeatureBlocks<Answer>& blocks, Answer& answer) {
    std::swap(answer.lists, rows);
    answer.count += static_cast<std::int64_t>(size_of(answer.lists));
    answer.any = true;
    blocks.take(answer);
    std::swap(answer.lists, rows);
}

template <class Answer>
OrderedBlocks<Lists<Answer>> blocks_of(const FeatureBlocks<Answer>& blocks, MemoryMeter& meter,
                                       Cancellation& cancellation, Answer& answer) {
    using Rows = Lists<Answer>;
    return {blocks.most,
            cancellation,
            {.make = [&] { return std::make_unique<Rows>(metered_answer<Answer>(&meter).lists); },
             .size = [](const Rows& rows) { return size_of(rows); },
             .append = [](Rows& to, Rows& piece, std::size_t begin,
                          std::size_t end) { append_rows(to, piece, begin, end); },
             .take = [&](Rows& rows) { take_rows(rows, blocks, answer); },
             .clear =
                 [](Rows& rows) {
                     for (auto& list : rows) clear(list);
                 }}};
}

/// Makes pieces of blocks by write(hits of a scene, lists).
template <class Hits, class Rows, class Write>
class FeaturePieces final : public RowStream<Hits> {
   public:
    FeaturePieces(OrderedBlocks<Rows>& blocks, Write write) : blocks_(blocks), write_(write) {}
    void add(std::int64_t unit, Hits& hits) override {
        auto piece = blocks_.make();
        write_(hits, *piece);
        for (auto& list : hits) list.clear();
        blocks_.add(unit, std::move(piece));
    }
    void finish(std::int64_t unit) override { blocks_.finish(unit); }
    void fail() override { blocks_.fail(); }

   private:
    OrderedBlocks<Rows>& blocks_;
    Write write_;
};

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

    auto ordered = blocks_of(blocks, meter_, cancellation_, answer);
    constexpr bool step = !is_near<Question>;
    if (in_place(question.filter)) {
        const PreparedScene scene = prepare_in_place(backend, step, question.weld);
        if constexpr (is_near<Question>) near_input_.place(outline_.shape(0));
        answer.edges = features_.edges();
        answer.first_edge.push_back(static_cast<std::int64_t>(answer.edges.size()));
        append_listed_points(0, answer);
        stream_scene(backend, scene, question, true, ordered, answer.statistics);
    } else {
        const bool one_world = outline_.worlds() == 1 && own_bodies(1) == 0;
        if (!one_world) list_features(backend, step, question.weld, answer);
        for (std::int32_t pass = 0; pass <= outline_.worlds(); ++pass) {
            cancellation_.check();
            const std::optional<PreparedScene> scene = prepare_pass(backend, pass, step, question.weld);
            if (!scene) continue;
            if constexpr (is_near<Question>) near_input_.place(outline_, scene_);
            if (one_world) append_features(pass, answer);
            stream_scene(backend, *scene, question, false, ordered, answer.statistics);
        }
    }
    ordered.finish();
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

template <class Question, class Blocks>
void FeatureSearch::stream_scene(BackendBase& backend, const PreparedScene& scene, const Question& question,
                                 bool in_place, Blocks& blocks, Statistics& statistics) {
    auto query = query_of(question, frugal_, features_, rule_);
    if constexpr (is_near<Question>) near_input_.tell(scene.vertex_count(), backend, cancellation_, query);
    Statistics of_scene;
    const auto append_pair = [&](FeatureTypes types, const Pair& found, auto& list) {
        Pair pair = found;
        BodyPair bodies{0, 0};
        if (!in_place) place(types, found, pair, bodies);
        list.pairs.push_back(pair);
        if (bodies_) list.bodies.push_back(bodies);
    };
    blocks.next_scene();
    if constexpr (is_candidates<Question>) {
        const auto write = [&](const CandidateHits& hits, auto& lists) {
            for (std::size_t k = 0; k < hits.size(); ++k)
                for (const Pair& pair : hits[k]) append_pair(types_of(static_cast<CandidateKind>(k)), pair, lists[k]);
        };
        FeaturePieces<CandidateHits, Lists<Candidates>, decltype(write)> pieces(blocks, write);
        backend.stream(scene, query, pieces, of_scene);
    } else {
        const auto write = [&](const FeatureHits& hits, auto& lists) {
            for (std::size_t k = 0; k < hits.size(); ++k) {
                const auto kind = static_cast<FeatureKind>(k);
                auto& list = lists[k];
                for (const FeatureHit& hit : hits[k]) {
                    append_pair(types_of(kind), hit.pair, list);
                    values(list).push_back(hit.value);
                    flags(list).push_back(hit.flag);
                }
                if constexpr (is_near<Question>) {
                    if (!question.closest) continue;
                    Array<ClosestPoints> closest(&meter_);
                    find_closest(scene, features_, kind, hits[k].span(), nullptr, closest);
                    for (const ClosestPoints& points : closest) {
                        list.type.push_back(points.type);
                        list.at.push_back(points.at);
                    }
                }
            }
        };
        using Rows = std::conditional_t<is_near<Question>, Lists<Proximities>, Lists<Impacts>>;
        FeaturePieces<FeatureHits, Rows, decltype(write)> pieces(blocks, write);
        backend.stream(scene, query, pieces, of_scene);
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
