#include "search/overlap/overlap_search.h"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <string>
#include <utility>

#include "crumple/error.h"
#include "results/intersection_output.h"
#include "results/overlap_output.h"
#include "results/withdrawal_output.h"
#include "search/containment/contained_bodies.h"
#include "search/withdrawal/withdrawal_search.h"

namespace crumple {
namespace {

/// Returns the middle of the intersection of two boxes: sums relative to it have the least cancellation.
Vec3d middle_of(const Bounds& a, const Bounds& b) {
    Vec3d middle;
    for (int axis = 0; axis < 3; ++axis) {
        middle[axis] = 0.5 * max(a.low[axis], b.low[axis]) + 0.5 * min(a.high[axis], b.high[axis]);
        if (!(std::abs(middle[axis]) >= 0x1p-150)) middle[axis] = 0;
    }
    return middle;
}

/// Returns all pairs of triangles of one surface that have a common point, in both orders: the pairs in `found`, and
/// all pairs of adjacent triangles, since `found` lacks those that meet only in their common vertices or edge.
std::vector<Pair> pairs_within(const ClosedSurface& surface, std::span<const Pair> found) {
    std::vector<Pair> pairs;
    for (const auto& [a, b] : found) {
        pairs.push_back({a, b});
        pairs.push_back({b, a});
    }
    std::vector<std::pair<std::int32_t, std::int32_t>> corners;  // vertex, triangle
    for (std::int32_t face = 0; face < surface.face_count(); ++face)
        for (std::size_t k = 0; k < 3; ++k) corners.emplace_back(surface.corners(face)[k], face);
    std::sort(corners.begin(), corners.end());
    for (std::size_t begin = 0, end = 0; begin < corners.size(); begin = end) {
        while (end < corners.size() && corners[end].first == corners[begin].first) ++end;
        for (std::size_t i = begin; i < end; ++i)
            for (std::size_t j = begin; j < end; ++j)
                if (corners[i].second != corners[j].second) pairs.push_back({corners[i].second, corners[j].second});
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    return pairs;
}

bool is_flag(Output output) { return output == Output::any || output == Output::any_by_world; }

}  // namespace

OverlapSearch::OverlapSearch(MemoryMeter& meter, Cancellation& cancellation, ClosedBodies& bodies)
    : meter_(meter),
      cancellation_(cancellation),
      bodies_(bodies),
      buffers_of_two_(&meter),
      found_(metered(&meter)),
      pairs_(&meter) {}

void OverlapSearch::release() {
    buffers_of_two_ = SceneBuffers(&meter_);
    found_ = metered(&meter_);
    pairs_.release();
    candidates_.clear();
    trees_.clear();
}

void OverlapSearch::find(BackendBase& backend, BackendBase& host, WorldSearch& worlds, const World& given,
                         const OverlapQuery& query, Overlaps& result) {
    host_ = &host;
    query_ = query;
    World world = given;
    std::vector<Body> bodies(given.bodies.begin(), given.bodies.end());
    for (Body& body : bodies) body.self = query.self_overlaps;
    world.bodies = bodies;
    bodies_.read(host, world, query.filter, query.weld);
    begin(query, outline().worlds(), outline().bodies(), result);
    add_skipped(list_candidates(), result);
    // If only flags are requested, most of them are set by surfaces that meet, and the search for such surfaces ends
    // early.
    const bool by_meeting = is_flag(query.output) && query.min_volume == 0 && !query.self_overlaps && none_is_open_;
    if (by_meeting)
        find_flags(backend, worlds, world, result);
    else
        find_rows(backend, worlds, world, result);
    result.statistics.triangles = outline().triangles();
    result.count = static_cast<std::int64_t>(result.bodies.size());
}

// True if there is a single candidate: two different bodies with unnamed shapes and identity poses.
bool OverlapSearch::is_one_unposed_pair() const {
    if (candidates_.size() != 1) return false;
    const auto [a, b] = candidates_[0].bodies;
    const auto is_unposed = [&](std::int32_t body) {
        return outline().placement(body).identity() && outline().shape(body).name == 0;
    };
    return a != b && is_unposed(a) && is_unposed(b);
}

// Backends search two meshes faster than a world.
void OverlapSearch::find_pairs_of_two(BackendBase& backend) {
    const auto mesh = [&](std::int32_t body) {
        const Shape& shape = outline().shape(body);
        return MeshView(shape.vertices, shape.triangles);
    };
    Candidate& candidate = candidates_[0];
    const MeshView a = mesh(candidate.bodies.first), b = mesh(candidate.bodies.second);
    const PreparedScene scene = prepare_scene(a, &b, false, *host_, buffers_of_two_);
    // Rows decide all pairs again. Only bounds on depths need to know beforehand which faces meet others.
    if (query_.depth_tolerance > 0)
        backend.find(scene, IntersectionQuery(), nullptr, found_);
    else
        backend.find_possible(scene, found_);
    std::swap(pairs_, found_.pairs);
    candidate.begin = 0;
    candidate.end = pairs_.size();
}

void OverlapSearch::find_flags(BackendBase& backend, WorldSearch& worlds, const World& world, Overlaps& result) {
    IntersectionQuery intersections;
    intersections.filter = query_.filter;
    intersections.output = query_.output;
    worlds.find(backend, world, intersections, found_);
    Array<BodyPair> apart(&meter_);
    for (const Candidate& candidate : candidates_) apart.push_back(candidate.bodies);
    leave_undecided(outline(), query_.output, found_, apart);
    ContainedBodies(meter_, cancellation_, bodies_, false).add(*host_, apart.span(), query_.output, found_);
    result.any = found_.any;
    std::copy(found_.world_hit.begin(), found_.world_hit.end(), result.world_hit.begin());
    result.statistics = found_.statistics;
}

void OverlapSearch::find_rows(BackendBase& backend, WorldSearch& worlds, const World& world, Overlaps& result) {
    if (is_one_unposed_pair()) {
        find_pairs_of_two(backend);
    } else {
        IntersectionQuery intersections;
        intersections.filter = query_.filter;
        worlds.find(backend, world, intersections, found_);
        sort_pairs();
    }
    result.statistics = found_.statistics;
    MemoryClaim memory(meter_);
    memory.add(candidates_.size() * sizeof(OverlapRow));
    trees_.clear();
    std::vector<OverlapRow> rows(candidates_.size());
    std::atomic<std::int64_t> rational{0};
    std::atomic<bool> enough{false};
    host_->parallel_for(candidates_.size(), [&](std::size_t i) {
        if (enough.load(std::memory_order_relaxed)) return;
        cancellation_.check();
        bool was_exact = false;
        rows[i] = row_of(candidates_[i], was_exact);
        memory.add(bytes_of(rows[i]));
        if (was_exact) rational.fetch_add(1, std::memory_order_relaxed);
        if (query_.output == Output::any && is_in_result(query_, rows[i]))
            enough.store(true, std::memory_order_relaxed);
    });
    trees_.clear();
    std::vector<std::int32_t> solids;  // ascending
    for (std::size_t i = 0; i < rows.size(); ++i)
        if (const auto [a, b] = candidates_[i].bodies; a == b && is_solid(rows[i])) solids.push_back(a);
    const auto is_solid_body = [&](std::int32_t body) {
        return query_.self_overlaps ? std::binary_search(solids.begin(), solids.end(), body) : query_.solids;
    };
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const BodyPair& bodies = candidates_[i].bodies;
        if (bodies.first == bodies.second) add_body(bodies.first, rows[i], result);
        if (is_in_result(query_, rows[i]))
            add_row(query_, bodies, outline().body(bodies.first).world, rows[i],
                    is_solid_body(bodies.first) && is_solid_body(bodies.second), result);
    }
    result.statistics.rational_tests += rational;
}

// Sorts the found pairs by pair of bodies, and sets the range of each candidate. The pairs arrive in the order of
// first body, its triangle, second body, its triangle.
void OverlapSearch::sort_pairs() {
    std::vector<std::size_t> order(found_.pairs.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto before = [&](std::size_t i, std::size_t j) { return found_.bodies[i] < found_.bodies[j]; };
    if (!std::is_sorted(order.begin(), order.end(), before)) std::stable_sort(order.begin(), order.end(), before);
    pairs_.resize_discard(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) pairs_[i] = found_.pairs[order[i]];
    std::size_t i = 0;
    for (Candidate& candidate : candidates_) {
        // Skips the pairs of triangles of bodies that are no candidates, because a surface is not closed.
        while (i < order.size() && found_.bodies[order[i]] < candidate.bodies) ++i;
        candidate.begin = i;
        while (i < order.size() && found_.bodies[order[i]] == candidate.bodies) ++i;
        candidate.end = i;
    }
}

// Lists the candidates: pairs of bodies whose boxes overlap and whose surfaces are closed; with OpenSurfaces::curves
// also pairs of different bodies whose surfaces are not. Returns the bodies that the result has to name as skipped.
std::vector<std::int32_t> OverlapSearch::list_candidates() {
    const Array<BodyPair> pairs = bodies_.near_pairs(query_.self_overlaps);
    std::vector<std::int32_t> open = bodies_.open_bodies(pairs.span(), query_.open, "OverlapQuery");
    none_is_open_ = open.empty();
    candidates_.clear();
    for (const BodyPair& pair : pairs) {
        const bool closed = bodies_.is_closed(pair.first) && bodies_.is_closed(pair.second);
        const bool has_curves = query_.open == OpenSurfaces::curves && pair.first != pair.second;
        if (closed || has_curves) candidates_.push_back({pair, 0, 0});
    }
    if (query_.open == OpenSurfaces::curves) open.clear();
    return open;
}

const SurfaceTree& OverlapSearch::tree_of(std::int32_t body) {
    std::unique_lock lock(trees_mutex_);
    auto& kept = trees_[body];
    lock.unlock();
    std::call_once(kept.first, [&] { kept.second = std::make_unique<PosedTree>(bodies_, body, &meter_); });
    return kept.second->tree;
}

OverlapRow OverlapSearch::row_of(const Candidate& candidate, bool& was_exact) {
    Array<Vec3d> points_a = bodies_.metered_points(), points_b = bodies_.metered_points();
    const auto [first, second] = candidate.bodies;
    const PlacedSurface a = bodies_.place(first, points_a);
    const std::span<const Pair> pairs(pairs_.data() + candidate.begin, candidate.end - candidate.begin);
    OverlapOfBodies overlap(*host_, host_->overlap_kernels(), meter_, cancellation_);
    const bool numbers = query_.output == Output::pairs;
    OverlapOfBodies::Request request{.numbers = numbers,
                                     .gradient = numbers && query_.gradient,
                                     .windings = numbers && query_.windings,
                                     .curves = numbers && query_.curves,
                                     .extents = numbers && (query_.extents || query_.regions),
                                     .regions = numbers && query_.regions,
                                     .unions = numbers && query_.unions,
                                     .min_volume = query_.min_volume};
    OverlapRow row;
    if (first == second) {
        request.orientation = bodies_.orientation(first);
        row = overlap.find_self(a, pairs_within(*a.surface, pairs), middle_of(a.box, a.box), request);
    } else {
        const PlacedSurface b = bodies_.place(second, points_b);
        const bool closed = a.surface->closed() && b.surface->closed();
        const Vec3d origin = middle_of(a.box, b.box);
        request.orientations = {bodies_.orientation(first), bodies_.orientation(second)};
        row = closed ? overlap.find(a, b, pairs, origin, request) : overlap.find_open(a, b, pairs, origin, request);
        const bool listed = numbers && is_in_result(query_, row);
        if (listed) was_exact |= add_withdrawals(a, b, row);
        if (listed && closed && (query_.depths || query_.depth_tolerance > 0))
            overlap.add_depths(query_, {&tree_of(first), &tree_of(second)}, row);
    }
    orient(bodies_.orientation(first), bodies_.orientation(second), row);
    was_exact |= overlap.was_exact();
    return row;
}

// Adds withdrawals to the row of two bodies, as requested. Returns true if some number needed rational arithmetic.
bool OverlapSearch::add_withdrawals(const PlacedSurface& a, const PlacedSurface& b, OverlapRow& row) const {
    if (query_.directions.empty() && !query_.translation) return false;
    MemoryClaim memory(meter_);
    memory.add(static_cast<std::size_t>(a.surface->face_count()) * projected_bytes_per_face);
    memory.add(static_cast<std::size_t>(b.surface->face_count()) * projected_bytes_per_face);
    WithdrawalCounts counts;
    const auto withdraw = [&](const Vec3d& direction) {
        return find_withdrawal(a, b, direction, *host_, cancellation_, counts);
    };
    const auto projected_area = [&](int side) {
        const PlacedSurface& surface = side == 0 ? a : b;
        ProjectedArea area;
        for (std::int32_t face = 0; face < surface.surface->face_count(); ++face) {
            cancellation_.check();
            area.add(surface.corners(face));
        }
        return area.bound();
    };
    crumple::add_withdrawals(query_, withdraw, projected_area, row);
    return counts.rational_tests != 0;
}

}  // namespace crumple
