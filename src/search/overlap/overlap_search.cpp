#include "search/overlap/overlap_search.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <string>
#include <utility>

#include "crumple/error.h"
#include "results/intersection_output.h"
#include "results/overlap_output.h"
#include "results/withdrawal_output.h"
#include "search/containment/contained_bodies.h"
#include "search/overlap/slice_of_world.h"
#include "search/withdrawal/first_free_search.h"
#include "search/withdrawal/withdrawal_search.h"

namespace crumple {
namespace {

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
    candidates_ = {};
    near_ = {};
    trees_.clear();
}

void OverlapSearch::find(BackendBase& backend, BackendBase& host, WorldSearch& worlds, const World& given,
                         const OverlapQuery& query, Overlaps& result, const OverlapBlocks* blocks,
                         const PairsOfParts* parts) {
    host_ = &host;
    device_ = backend.overlap_device();
    query_ = query;
    blocks_ = blocks;
    parts_ = parts;
    delivered_ = 0;
    rational_ = 0;
    World world = given;
    std::vector<Body> bodies(given.bodies.begin(), given.bodies.end());
    for (Body& body : bodies) body.self = query.self_overlaps;
    world.bodies = bodies;
    bodies_.read(host, world, query.filter, query.weld);
    begin(query, outline().worlds(), outline().bodies(), result);
    add_skipped(list_candidates(), result);
    // If only flags are requested, most of them are set by surfaces that meet, and the search for such surfaces ends
    // early.
    const bool by_meeting =
        is_flag(query.output) && query.min_volume == 0 && !query.self_overlaps && none_is_open_ && !parts;
    if (by_meeting) {
        find_flags(backend, worlds, world, result);
    } else if (blocks) {
        result.world_hit.clear();
        stream_rows(backend, worlds, world, result);
    } else {
        find_rows(backend, worlds, world, result);
    }
    result.statistics.triangles = outline().triangles();
    result.statistics.rational_tests += rational_;
    result.count = blocks ? delivered_ : static_cast<std::int64_t>(result.bodies.size());
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
    bool decides = query_.depth_tolerance > 0;
    try {
        if (!decides) backend.find_possible(scene, found_);
    } catch (const MemoryMeter::Exceeded&) {
        decides = true;  // fewer pairs may fit
    }
    if (decides) backend.find(scene, IntersectionQuery(), nullptr, found_);
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

void OverlapSearch::find_pairs(BackendBase& backend, WorldSearch& worlds, const World& world, Candidates candidates,
                               Statistics& statistics) {
    if (parts_) return read_pairs(candidates);
    if (is_one_unposed_pair()) {
        find_pairs_of_two(backend);
        add_pass(found_.statistics, statistics);
        return;
    }
    IntersectionQuery intersections;
    intersections.filter = query_.filter;
    if (!blocks_ || candidates.size() == near_.size()) {
        worlds.find(backend, world, intersections, found_);
    } else {
        std::vector<BodyPair> pairs;
        for (const Candidate& candidate : candidates) pairs.push_back(candidate.bodies);
        const SliceOfWorld slice(world, query_.filter, near_, pairs);
        intersections.filter = slice.filter();
        worlds.find(backend, slice.world(), intersections, found_);
        for (auto& [a, b] : found_.bodies) a = slice.body(a), b = slice.body(b);
    }
    sort_pairs(candidates);
    add_pass(found_.statistics, statistics);
}

// Returns the rows of candidates whose pairs of triangles are known. Ends after the first row if it decides the result.
std::vector<OverlapRow> OverlapSearch::make_rows(Candidates candidates, MemoryClaim& memory) {
    memory.add(candidates.size() * sizeof(OverlapRow));
    std::vector<OverlapRow> rows(candidates.size());
    const std::unique_ptr<OverlapBatch> batch = cross_on_device(candidates);
    std::atomic<bool> enough{false};
    host_->parallel_for(candidates.size(), [&](std::size_t i) {
        if (enough.load(std::memory_order_relaxed)) return;
        cancellation_.check();
        bool was_exact = false;
        const CrossedRow* crossed = batch ? batch->row(i) : nullptr;
        if (crossed) {
            rows[i] =
                row_of(candidates[i].bodies, batch->surface(crossed->surface[0]), batch->surface(crossed->surface[1]),
                       batch->pairs(*crossed), batch->on_device(*crossed), was_exact);
        } else {
            rows[i] = row_of(candidates[i], was_exact);
        }
        memory.add(bytes_of(rows[i]));
        if (was_exact) rational_.fetch_add(1, std::memory_order_relaxed);
        if (query_.output == Output::any && is_in_result(query_, rows[i]))
            enough.store(true, std::memory_order_relaxed);
    });
    if (device_) device_->end_batch();
    return rows;
}

// Lets the device decide the pairs of triangles of the candidates. Returns null if the host has to do it.
std::unique_ptr<OverlapBatch> OverlapSearch::cross_on_device(Candidates candidates) {
    if (!device_ || query_.output == Output::any) return nullptr;  // `any` ends after the first row
    std::vector<OverlapBatch::Row> rows;
    for (const Candidate& candidate : candidates) rows.push_back({candidate.bodies, pairs_of(candidate)});
    auto batch = std::make_unique<OverlapBatch>(bodies_, meter_);
    if (!batch->cross(*device_, rows, query_.output == Output::pairs, *host_)) return nullptr;
    cancellation_.check();
    return batch;
}

void OverlapSearch::find_rows(BackendBase& backend, WorldSearch& worlds, const World& world, Overlaps& result) {
    find_pairs(backend, worlds, world, candidates_, result.statistics);
    trees_.clear();
    MemoryClaim memory(meter_);
    const std::vector<OverlapRow> rows = make_rows(candidates_, memory);
    trees_.clear();
    std::vector<std::int32_t> solids;  // ascending
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto [a, b] = candidates_[i].bodies;
        if (a != b) continue;
        add_body(a, rows[i], result);
        if (is_solid(rows[i])) solids.push_back(a);
    }
    const auto is_solid_body = [&](std::int32_t body) {
        return query_.self_overlaps ? std::binary_search(solids.begin(), solids.end(), body) : query_.solids;
    };
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const BodyPair& bodies = candidates_[i].bodies;
        add_if_in_result(candidates_[i], rows[i], is_solid_body(bodies.first) && is_solid_body(bodies.second), result);
    }
}

void OverlapSearch::add_if_in_result(const Candidate& candidate, const OverlapRow& row, bool solids,
                                     Overlaps& result) const {
    if (is_in_result(query_, row))
        add_row(query_, candidate.bodies, outline().body(candidate.bodies.first).world, row, solids, result);
}

// Calls each(candidates) for one slice of the candidates after another, whose pairs of triangles are known.
template <class Each>
void OverlapSearch::for_each_slice(BackendBase& backend, WorldSearch& worlds, const World& world, Each each,
                                   Statistics& statistics) {
    for (std::size_t begin = 0, end = 0; begin < candidates_.size(); begin = end) {
        cancellation_.check();
        end = end_of_slice(begin);
        const Candidates slice = Candidates(candidates_).subspan(begin, end - begin);
        find_pairs(backend, worlds, world, slice, statistics);
        each(slice);
        trees_.clear();
    }
}

// Ends a slice where the triangles of the smaller bodies of its pairs, which bound the usual number of pairs of
// triangles, exceed those of the world. So slices are few, and a search of all of them takes few searches of the world.
std::size_t OverlapSearch::end_of_slice(std::size_t begin) const {
    const std::int64_t most = std::max(outline().triangles(), 4 * std::min(blocks_->most, std::int64_t{1} << 30));
    std::int64_t triangles = 0;
    std::size_t end = begin;
    while (end < candidates_.size() && triangles < most) {
        const auto [a, b] = candidates_[end++].bodies;
        triangles += std::min(outline().shape(a).triangles.rows, outline().shape(b).triangles.rows);
    }
    return end;
}

// Fills the lists by body, which all blocks have, and removes the pairs of solids with themselves, which have no row.
void OverlapSearch::find_bodies(BackendBase& backend, WorldSearch& worlds, const World& world, Overlaps& result) {
    if (result.body_volume.empty()) return;
    std::vector<Candidate> all = std::exchange(candidates_, {});
    const auto is_self = [](const Candidate& candidate) { return candidate.bodies.first == candidate.bodies.second; };
    std::copy_if(all.begin(), all.end(), std::back_inserter(candidates_), is_self);
    const OverlapQuery query = query_;
    query_.gradient = query_.windings = false;
    const auto read_bodies = [&](Candidates slice) {
        MemoryClaim memory(meter_);
        const std::vector<OverlapRow> rows = make_rows(slice, memory);
        for (std::size_t i = 0; i < rows.size(); ++i) add_body(slice[i].bodies.first, rows[i], result);
    };
    for_each_slice(backend, worlds, world, read_bodies, result.statistics);
    query_ = query;
    std::erase_if(all, [&](const Candidate& candidate) {
        return is_self(candidate) && result.is_solid[candidate.bodies.first] != 0;
    });
    candidates_ = std::move(all);
}

void OverlapSearch::stream_rows(BackendBase& backend, WorldSearch& worlds, const World& world, Overlaps& result) {
    constexpr std::size_t least_at_once = 16, most_at_once = 1024, most_pairs = 1 << 20;
    const std::size_t at_once = std::clamp(static_cast<std::size_t>(blocks_->most), least_at_once, most_at_once);
    trees_.clear();
    find_bodies(backend, worlds, world, result);
    const auto is_solid_body = [&](std::int32_t body) {
        return query_.self_overlaps ? !result.is_solid.empty() && result.is_solid[body] != 0 : query_.solids;
    };
    const auto add_rows = [&](Candidates some) {
        MemoryClaim memory(meter_);
        const std::vector<OverlapRow> rows = make_rows(some, memory);
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const auto [a, b] = some[i].bodies;
            add_if_in_result(some[i], rows[i], is_solid_body(a) && is_solid_body(b), result);
            if (static_cast<std::int64_t>(result.bodies.size()) == blocks_->most) deliver(result);
        }
    };
    const auto add_slice = [&](Candidates slice) {
        for (std::size_t begin = 0, end = 0; begin < slice.size(); begin = end) {
            end = begin + 1;
            while (end < slice.size() && end - begin < at_once && slice[end].end - slice[begin].begin <= most_pairs)
                ++end;
            add_rows(slice.subspan(begin, end - begin));
        }
    };
    for_each_slice(backend, worlds, world, add_slice, result.statistics);
    const bool has_lists = !result.skipped.empty() || !result.body_volume.empty();
    if (!result.bodies.empty() || (delivered_ == 0 && has_lists)) deliver(result);
}

void OverlapSearch::deliver(Overlaps& result) {
    cancellation_.check();
    delivered_ += static_cast<std::int64_t>(result.bodies.size());
    result.count = delivered_;
    blocks_->take(result);
    clear_rows(result);
}

// Sorts the found pairs by pair of bodies, and sets the range of each candidate. The pairs arrive in the order of
// first body, its triangle, second body, its triangle.
void OverlapSearch::sort_pairs(Candidates candidates) {
    std::vector<std::size_t> order(found_.pairs.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto before = [&](std::size_t i, std::size_t j) { return found_.bodies[i] < found_.bodies[j]; };
    if (!std::is_sorted(order.begin(), order.end(), before)) std::stable_sort(order.begin(), order.end(), before);
    pairs_.resize_discard(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) pairs_[i] = found_.pairs[order[i]];
    std::size_t i = 0;
    for (Candidate& candidate : candidates) {
        // Skips the pairs of triangles of bodies that are no candidates, because a surface is not closed.
        while (i < order.size() && found_.bodies[order[i]] < candidate.bodies) ++i;
        candidate.begin = i;
        while (i < order.size() && found_.bodies[order[i]] == candidate.bodies) ++i;
        candidate.end = i;
    }
}

// Reads the pairs of candidates that the parts of the scene have found.
void OverlapSearch::read_pairs(Candidates candidates) {
    pairs_.clear();
    for (Candidate& candidate : candidates) {
        cancellation_.check();
        candidate.begin = pairs_.size();
        parts_->append(candidate.bodies, pairs_);
        candidate.end = pairs_.size();
    }
}

// Lists the candidates: pairs of bodies whose boxes overlap and whose surfaces are closed; with OpenSurfaces::curves
// also pairs of different bodies whose surfaces are not. Returns the bodies that the result has to name as skipped.
std::vector<std::int32_t> OverlapSearch::list_candidates() {
    const Array<BodyPair> pairs = bodies_.near_pairs(query_.self_overlaps);
    std::vector<std::int32_t> open = bodies_.open_bodies(pairs.span(), query_.open, "OverlapQuery");
    none_is_open_ = open.empty();
    candidates_.clear();
    near_.assign(pairs.begin(), pairs.end());
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
    if (pairs_of(candidate).empty() && first != second && !bodies_.may_enclose(first, second)) return {};
    const PlacedSurface a = bodies_.place(first, points_a);
    if (first == second)
        return row_of(candidate.bodies, a, a, pairs_within(*a.surface, pairs_of(candidate)), {}, was_exact);
    return row_of(candidate.bodies, a, bodies_.place(second, points_b), pairs_of(candidate), {}, was_exact);
}

// Returns the row of two bodies, whose pairs a device may have decided.
OverlapRow OverlapSearch::row_of(const BodyPair& bodies, const PlacedSurface& a, const PlacedSurface& b,
                                 std::span<const Pair> pairs, const RowOnDevice& on_device, bool& was_exact) {
    const auto [first, second] = bodies;
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
    overlap.set_on_device(on_device);
    const Vec3d origin = middle_of(a.box, b.box);
    if (first == second) {
        request.orientation = bodies_.orientation(first);
        row = overlap.find_self(a, pairs, origin, request);
    } else {
        const bool closed = a.surface->closed() && b.surface->closed();
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
    if (!query_.first_free || !a.surface->closed() || !b.surface->closed()) return counts.rational_tests != 0;
    FirstFreeCounts steps;
    for (const auto& [x, y, z] : query_.directions)
        row.first_free.push_back(find_first_free(a, b, {x, y, z}, *host_, cancellation_, meter_, steps));
    return true;
}

}  // namespace crumple
