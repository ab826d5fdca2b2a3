// Delivers results about features of worlds in blocks: converts the backend's rows to bodies and indices within bodies,
// and collects them until a block is full. A block may have rows of several worlds.

#include <algorithm>
#include <memory>
#include <tuple>
#include <type_traits>
#include <utility>

#include "results/intersection_output.h"
#include "results/near_details.h"
#include "results/ordered_blocks.h"
#include "search/feature_search.h"

namespace crumple {
namespace {

/// Rows of a block, by kind.
template <class Answer>
using Lists = decltype(Answer::lists);

/// Returns references to the columns of a list, without its offsets.
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
    to.grow_by(end - begin);
    for (std::size_t i = begin; i < end; ++i) to.push_back(from[i]);
}

// Appends rows [begin, end) of `piece` to `to`, kind by kind. Rows are counted over all lists of `piece`, one after
// another.
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

// Delivers rows as a block.
template <class Answer>
void consume_rows(Lists<Answer>& rows, const FeatureBlocks<Answer>& blocks, Answer& answer) {
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
            {.make = [&] { return std::make_unique<Rows>(metered_result<Answer>(&meter).lists); },
             .size = [](const Rows& rows) { return size_of(rows); },
             .append = [](Rows& to, Rows& piece, std::size_t begin,
                          std::size_t end) { append_rows(to, piece, begin, end); },
             .take = [&](Rows& rows) { consume_rows(rows, blocks, answer); },
             .clear =
                 [](Rows& rows) {
                     for (auto& list : rows) clear(list);
                 }}};
}

/// Converts the rows that a backend delivers to pieces of blocks (results/ordered_blocks.h) by write(rows, lists).
template <class Block, class Write>
class FeaturePieces final : public FeatureStream {
   public:
    FeaturePieces(OrderedBlocks<Block>& blocks, Write write) : blocks_(blocks), write_(write) {}
    void add(std::int64_t unit, RowLists& rows) override {
        auto piece = blocks_.make();
        write_(rows, *piece);
        rows.clear();
        blocks_.add(unit, std::move(piece));
    }
    void finish(std::int64_t unit) override { blocks_.finish(unit); }
    void fail() override { blocks_.fail(); }

   private:
    OrderedBlocks<Block>& blocks_;
    Write write_;
};

}  // namespace

template <class Query>
void FeatureSearch::stream(BackendBase& backend, const World& world, const Query& query, bool bodies, bool low_memory,
                           const FeatureBlocks<typename Query::Result>& blocks, typename Query::Result& result) {
    bodies_ = bodies;
    low_memory_ = low_memory;
    read(world, query.filter);
    clear(result);
    result.statistics.triangles = outline_.triangles();
    if constexpr (is_candidates<Query>) result.listed = listed_kinds(query);
    result.first_edge.push_back(0);
    result.first_point.push_back(0);
    if constexpr (is_near<Query>) proximity_input_.begin(outline_, query, bodies_, true, backend, buffers_);

    auto ordered = blocks_of(blocks, meter_, cancellation_, result);
    constexpr bool step = !is_near<Query>;
    if (in_place(query.filter)) {
        const PreparedScene scene = prepare_in_place(backend, step, query.weld);
        if constexpr (is_near<Query>) proximity_input_.place(outline_.shape(0));
        result.edges = features_.edges();
        result.first_edge.push_back(static_cast<std::int64_t>(result.edges.size()));
        append_codimensional_points(0, result);
        stream_scene(backend, scene, query, true, ordered, result.statistics);
    } else {
        const bool one_world = outline_.worlds() == 1 && own_bodies(1) == 0;
        if (!one_world) list_features(backend, step, query.weld, result);
        for (std::int32_t pass = 0; pass <= outline_.worlds(); ++pass) {
            cancellation_.check();
            const std::optional<PreparedScene> scene = prepare_pass(backend, pass, step, query.weld);
            if (!scene) continue;
            if constexpr (is_near<Query>) proximity_input_.place(outline_, scene_);
            if (one_world) append_features(pass, result);
            stream_scene(backend, *scene, query, false, ordered, result.statistics);
        }
    }
    ordered.finish();
    result.statistics.pairs = result.count;
}

// Lists the edges and points of all worlds. Each block has them, so they are needed before the first block.
template <class Result>
void FeatureSearch::list_features(BackendBase& backend, bool step, bool weld, Result& result) {
    for (std::int32_t pass = 0; pass <= outline_.worlds(); ++pass) {
        cancellation_.check();
        if (prepare_pass(backend, pass, step, weld)) append_features(pass, result);
    }
}

template <class Query, class Blocks>
void FeatureSearch::stream_scene(BackendBase& backend, const PreparedScene& scene, const Query& query, bool in_place,
                                 Blocks& blocks, Statistics& statistics) {
    FeatureRequest request = request_of(query, low_memory_, features_, scene_filter_);
    if constexpr (is_near<Query>) proximity_input_.tell(scene.vertex_count(), backend, cancellation_, request);
    const auto write = [&](const RowLists& found, Lists<typename Query::Result>& lists) {
        for (std::size_t k = 0; k < lists.size(); ++k) {
            const auto kind = static_cast<KindOf<Query>>(k);
            append_rows(types_of(kind), found[kind], in_place, lists[k]);
            if constexpr (is_near<Query>)
                if (query.closest) append_closest(scene, features_, kind, found[kind].pairs, nullptr, lists[k]);
        }
    };
    blocks.next_scene();
    FeaturePieces<Lists<typename Query::Result>, decltype(write)> pieces(blocks, write);
    Statistics of_scene;
    backend.stream(scene, request, pieces, of_scene);
    add_pass(of_scene, statistics);
}

template void FeatureSearch::stream(BackendBase&, const World&, const ImpactQuery&, bool, bool,
                                    const FeatureBlocks<Impacts>&, Impacts&);
template void FeatureSearch::stream(BackendBase&, const World&, const ProximityQuery&, bool, bool,
                                    const FeatureBlocks<Proximities>&, Proximities&);
template void FeatureSearch::stream(BackendBase&, const World&, const CandidateQuery&, bool, bool,
                                    const FeatureBlocks<Candidates>&, Candidates&);

}  // namespace crumple
