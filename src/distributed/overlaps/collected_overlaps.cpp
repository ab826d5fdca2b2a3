// Overlap queries on a rank. Bodies stay whole:
//
//     query, input   compare queries, number bodies over all ranks, as in collected_bodies.cpp
//     place          boxes of all bodies -> pairs of bodies, and the rank of each (pairs_of_bodies.h)
//     room           send bodies to the ranks that search them (body_copies.h)
//     search         the overlaps of each body with itself, and those of pairs, as on a single machine
//     rows, output   rows to the rank of their first body
//
// A row depends on the shapes and poses of its two bodies only, so it has the bytes of a single machine.

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <utility>

#include "distributed/overlaps/body_copies.h"
#include "distributed/overlaps/overlap_messages.h"
#include "distributed/overlaps/pairs_of_bodies.h"
#include "distributed/rank_detector.h"
#include "results/intersection_output.h"
#include "results/overlap_output.h"
#include "results/overlap_rows.h"
#include "scene/open_surface.h"
#include "search/overlap/slice_of_world.h"

namespace crumple::distribute {
namespace {

// Returns the pair filter for the bodies that a rank searches, which have other numbers.
PairFilter filter_of(const PairFilter& filter, const BodyCopies& copies) {
    PairFilter mine = filter;
    mine.excluded_bodies.clear();
    for (const auto& [a, b] : filter.excluded_bodies)
        if (const BodyPair pair{copies.place_of(a), copies.place_of(b)}; pair.first >= 0 && pair.second >= 0)
            mine.excluded_bodies.push_back(pair);
    return mine;
}

// Returns the pairs of which a rank has both bodies, by their places among the bodies that it searches.
std::vector<BodyPair> placed(std::span<const BodyPair> pairs, const BodyCopies& copies) {
    std::vector<BodyPair> mine;
    for (const auto& [a, b] : pairs)
        if (const BodyPair pair{copies.place_of(a), copies.place_of(b)}; pair.first >= 0 && pair.second >= 0)
            mine.push_back(pair);
    return mine;
}

/// Numbers of a body that its overlap with itself determines, as integers that ranks add up.
struct BodyNumbers {
    std::vector<std::int64_t> numbers;

    explicit BodyNumbers(std::int32_t bodies) : numbers(2 * static_cast<std::size_t>(bodies), 0) {}
    void set(std::int32_t body, double volume, bool solid) {
        numbers[2 * static_cast<std::size_t>(body)] = std::bit_cast<std::int64_t>(volume);
        numbers[2 * static_cast<std::size_t>(body) + 1] = solid ? 2 : 1;
    }
    bool is_solid(std::int32_t body) const { return numbers[2 * static_cast<std::size_t>(body) + 1] == 2; }
    double volume(std::int32_t body) const {
        const auto i = 2 * static_cast<std::size_t>(body);
        return numbers[i + 1] == 0 ? std::numeric_limits<double>::quiet_NaN() : std::bit_cast<double>(numbers[i]);
    }
};

}  // namespace

const DistributedOverlaps& RankDetector::find(const LocalWorld& local, const OverlapQuery& query,
                                              std::stop_token stop) {
    overlaps_ = {};
    guard(std::move(stop), [&] {
        check_(Phase::query, [&] {
            compared_ = request_of_ranks(query, local.world);
            bodies_.outline_whole(local, query.filter);
        });
        check_query_of_ranks(bodies_.local_mesh(), nullptr);
        bodies_.number_whole(transport_, check_);
        find_overlaps(query);
    });
    overlaps_.statistics = statistics_;
    return overlaps_;
}

void RankDetector::find_overlaps(const OverlapQuery& query) {
    PairsOfBodies pairs;
    list_pairs_of_bodies(query, pairs);
    BodyCopies copies(engine_->memory());
    copies.exchange(batches_, check_, bodies_, pairs);
    // Overlaps of bodies with themselves, and of pairs:
    std::array found{metered_overlaps(&engine_->memory()), metered_overlaps(&engine_->memory())};
    bool any = false;
    search_overlaps(query, pairs, copies, found, any);
    const bool listed = query.output == Output::pairs || query.output == Output::body_pairs;
    if (listed) collect_overlaps(query, found);
    std::array<std::int64_t, 2> totals{std::int64_t{any}, static_cast<std::int64_t>(overlaps_.rows.bodies.size())};
    reduce(totals, Reduction::sum);
    overlaps_.any = totals[0] > 0;
    overlaps_.count = totals[1];
    statistics_.search.pairs = overlaps_.rows.count;
    std::array<std::int64_t, 2> work{static_cast<std::int64_t>(1e6 * statistics_.work_milliseconds), 0};
    work[1] = work[0];
    reduce({&work[0], 1}, Reduction::max);
    reduce({&work[1], 1}, Reduction::sum);
    statistics_.largest_work = 1e-6 * static_cast<double>(work[0]);
    statistics_.mean_work = 1e-6 * static_cast<double>(work[1]) / transport_.size();
}

// Lists the pairs of bodies of all ranks, and assigns them to ranks. Handles bodies whose surfaces are not closed as a
// single machine does.
void RankDetector::list_pairs_of_bodies(const OverlapQuery& query, PairsOfBodies& pairs) {
    const WorldOutline& local = bodies_.local();
    std::vector<PairsOfBodies::Row> rows;
    std::vector<std::pair<std::size_t, OpenEdge>> open_edges;  // by local body: number of open edges, and the first
    check_(Phase::input, [&] {
        bodies_.check_whole();
        open_edges.resize(static_cast<std::size_t>(local.bodies()));
        World world = local.world();
        std::vector<Shape> shapes;
        for (const Shape& shape : world.shapes) shapes.emplace_back(shape.vertices, shape.triangles);
        world.shapes = shapes;
        engine_->read_surfaces(world, query.weld, stop_, [&](const ClosedBodies& surfaces) {
            rows.clear();
            for (std::int32_t b = 0; b < local.bodies(); ++b) {
                Array<Vec3d> points = surfaces.metered_points();
                const bool empty = local.shape(b).triangles.rows == 0;
                const Bounds box = empty ? no_bounds : surfaces.place(b, points).box;
                rows.push_back({box, local.body(b).group, surfaces.is_closed(b)});
                if (surfaces.is_closed(b)) continue;
                const Array<OpenEdge> edges = surfaces.surface(b).open_edges();
                open_edges[static_cast<std::size_t>(b)] = {edges.size(), edges[0]};
            }
        });
    });
    pairs.tabulate(transport_, check_, bodies_, rows);
    check_(Phase::place, [&] {
        pairs.list(query);
        std::vector<std::int32_t> open(pairs.open_bodies().begin(), pairs.open_bodies().end());
        const std::int32_t first_open = open.empty() ? -1 : open.front();
        std::sort(open.begin(), open.end());
        for (std::int32_t b = 0; b < local.bodies(); ++b) {
            const std::int32_t number = bodies_.number_of(b);
            if (!std::binary_search(open.begin(), open.end(), number)) continue;
            const auto& [count, first] = open_edges[static_cast<std::size_t>(b)];
            if (query.open == OpenSurfaces::error && number == first_open)
                fail_open_surface(number, count, first, "OverlapQuery");
            if (query.open == OpenSurfaces::skip) overlaps_.rows.skipped.push_back(number);
        }
        std::sort(overlaps_.rows.skipped.begin(), overlaps_.rows.skipped.end());
        pairs.assign(bodies_, transport_.size());
    });
}

// Finds the overlaps of the pairs of this rank: first of bodies with themselves, each of which is a world of its own,
// because only then all ranks know which bodies are solids.
void RankDetector::search_overlaps(const OverlapQuery& query, const PairsOfBodies& pairs, const BodyCopies& copies,
                                   std::array<Overlaps, 2>& found, bool& any) {
    BodyNumbers numbers(0);
    check_(Phase::search, [&] {
        if (query.self_overlaps && query.output == Output::pairs) numbers = BodyNumbers(bodies_.count());
        const std::vector<BodyPair> mine = placed(pairs.pairs_of(transport_.rank()), copies);
        std::vector<BodyPair> with_itself, between;
        for (const BodyPair& pair : mine) (pair.first == pair.second ? with_itself : between).push_back(pair);
        DistributedProgress progress{Phase::search, 0, static_cast<int>(mine.size())};
        if (show_) show_(progress);
        const double begin = clock_();
        const auto find = [&](const SliceOfWorld& slice, const World& world, const OverlapQuery& of_slice,
                              Overlaps& to) {
            const Overlaps& in_slice = engine_->find(world, of_slice, stop_);
            any = any || in_slice.any;
            add_pass(in_slice.statistics, statistics_.search);
            to = in_slice;
            number_bodies(to, [&](std::int32_t body) { return copies.number_of(slice.body(body)); });
            for (std::size_t b = 0; !numbers.numbers.empty() && b < to.body_volume.size(); ++b)
                numbers.set(copies.number_of(slice.body(static_cast<std::int32_t>(b))), to.body_volume[b],
                            to.is_solid[b] != 0);
        };
        if (!with_itself.empty()) {
            const SliceOfWorld slice(copies.world(), {}, {}, with_itself);
            std::vector<Body> apart(slice.world().bodies.begin(), slice.world().bodies.end());
            for (std::size_t b = 0; b < apart.size(); ++b) apart[b].world = static_cast<std::int32_t>(b);
            World world = slice.world();
            world.bodies = apart;
            OverlapQuery of_bodies = query;
            of_bodies.filter = {};
            find(slice, world, of_bodies, found[0]);
            progress.parts_done = static_cast<int>(with_itself.size());
            if (show_) show_(progress);
        }
        const bool decided = any && (query.output == Output::any || query.output == Output::any_by_world);
        if (!between.empty() && !decided) {
            const SliceOfWorld slice(copies.world(), filter_of(query.filter, copies), placed(pairs.near(), copies),
                                     between);
            OverlapQuery of_pairs = query;
            of_pairs.filter = slice.filter();
            of_pairs.self_overlaps = false;
            if (query.self_overlaps) of_pairs.solids = true;  // bounds that hold for solids; see below
            find(slice, slice.world(), of_pairs, found[1]);
            progress.parts_done = progress.parts;
            if (show_) show_(progress);
        }
        statistics_.work_milliseconds = clock_() - begin;
        statistics_.parts = static_cast<int>(mine.size());
        for (const auto& [a, b] : mine)
            statistics_.members +=
                bodies_.triangles_of(copies.number_of(a)) + (a == b ? 0 : bodies_.triangles_of(copies.number_of(b)));
    });
    if (numbers.numbers.empty()) return;
    reduce(numbers.numbers, Reduction::sum);  // only one rank has searched a body with itself
    Overlaps& of_pairs = found[1];
    for (std::size_t i = 0; i < of_pairs.translation_low.size(); ++i)
        if (const auto [a, b] = of_pairs.bodies[i]; !numbers.is_solid(a) || !numbers.is_solid(b))
            of_pairs.translation_low[i] = std::numeric_limits<double>::quiet_NaN();
    for (std::int32_t b = 0; b < bodies_.local().bodies(); ++b) {
        overlaps_.rows.body_volume.push_back(numbers.volume(bodies_.number_of(b)));
        overlaps_.rows.is_solid.push_back(numbers.is_solid(bodies_.number_of(b)));
    }
}

// Sends rows to the ranks of their first bodies.
void RankDetector::collect_overlaps(const OverlapQuery& query, std::array<Overlaps, 2>& found) {
    OverlapMessages messages(transport_.size(), engine_->memory());
    check_(Phase::rows, [&] {
        for (const Overlaps& rows : found)
            for (std::size_t begin = 0, end = 0; begin < rows.bodies.size(); begin = end) {
                const int rank = bodies_.rank_of(rows.bodies[begin].first);
                while (end < rows.bodies.size() && bodies_.rank_of(rows.bodies[end].first) == rank) ++end;
                append_rows(rows, begin, end, messages.for_rank(rank));
            }
        found = {};
        begin_rows(query, overlaps_.rows);
    });
    messages.exchange(batches_, check_, overlaps_.rows);
}

}  // namespace crumple::distribute
