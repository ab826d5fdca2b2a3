#include "search/overlap/overlap_row.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>

#include "exact/intersection/decide_intersection.h"
#include "exact/overlap/exact_crossing.h"
#include "exact/overlap/filtered_crossing.h"
#include "search/depth/overlap_depth.h"
#include "search/depth/overlap_depth_bound.h"
#include "search/overlap/overlap_blocks.h"
#include "search/overlap/overlap_contact_area.h"

namespace crumple {
namespace {

/// Result for a chunk of triangle pairs: steps of winding numbers, segments and coplanar pairs.
struct CrossedPairs {
    std::array<std::array<WindingSteps, 2>, 2> steps;  ///< by shift (forward, backward) and by surface (first, second)
    std::vector<Segment> segments, links;
    std::vector<Pair> coplanar;
    bool meet = false;  ///< true if an edge crosses a face after a shift: then the faces have a common point without it

    std::size_t bytes() const {
        std::size_t bytes = bytes_of(segments) + bytes_of(links) + bytes_of(coplanar);
        for (const auto& shifted : steps)
            for (const WindingSteps& of_side : shifted) bytes += of_side.bytes();
        return bytes;
    }
};

/// True if an edge of a face crosses the other face.
bool crosses(const FaceCrossing& jumps) { return jumps.segment || jumps.a != EdgeJumps{} || jumps.b != EdgeJumps{}; }

/// True if two faces have a common point.
bool faces_meet(const FaceCorners& a, const FaceCorners& b) {
    DecisionCounts counts;
    return collide({a, {0, 1, 2}}, {b, {3, 4, 5}}, Neighbours::geometric, IntersectionKind::all, counts);
}

/// Adds a segment without length if edges of a degenerate face cross the other face.
void add_link(const Pair& pair, const FaceCrossing& jumps, std::vector<Segment>& links) {
    Segment& link = links.emplace_back(segment_of(jumps, [](std::size_t, std::size_t) { return -1; }));
    link.a = pair.a, link.b = pair.b;
}

}  // namespace

OverlapRow OverlapOfBodies::find(const PlacedSurface& a, const PlacedSurface& b, std::span<const Pair> pairs,
                                 const Vec3d& origin, const Request& request) {
    sums_.surfaces = {{&a, &b}, origin};
    pairs_ = pairs;
    return find(request);
}

OverlapRow OverlapOfBodies::find_self(const PlacedSurface& body, std::span<const Pair> pairs, const Vec3d& origin,
                                      const Request& request) {
    sums_.surfaces = {{&body, &body}, origin};
    pairs_ = pairs;
    self_ = request.orientation;
    OverlapRow row = find(request);
    row.body_volume = volume_of_body();
    return row;
}

OverlapRow OverlapOfBodies::find_open(const PlacedSurface& a, const PlacedSurface& b, std::span<const Pair> pairs,
                                      const Vec3d& origin, const Request& request) {
    sums_.surfaces = {{&a, &b}, origin};
    pairs_ = pairs;
    OverlapRow row;
    row.relation = OverlapRelation::undefined;
    row.numbers = undefined_numbers(origin);
    cross_pairs(false);
    row.exists = surfaces_meet_;
    if (!row.exists || !request.numbers) return row;
    row.numbers.contact_area = contact_area();
    forward_ = forward_segments();
    if (request.curves) row.curves = curves(origin);
    return row;
}

OverlapRow OverlapOfBodies::find(const Request& request) {
    sums_.numbers = request.numbers;
    cross_pairs(request.gradient);
    find_windings(request.gradient);
    OverlapRow row;
    row.exists = surfaces_meet_ || !steps(0).intervals().empty() || !steps(1).intervals().empty();
    if (!row.exists) return row;
    count_faces();
    if (self_ == 0 && (request.curves || request.regions || request.extents)) forward_ = forward_segments();
    // Regions come first if their sums make those of the row, unless a row without the least volume needs no regions.
    const bool has_regions = request.regions && self_ == 0;
    const bool sums_regions = has_regions && request.min_volume == 0 && regions_have_all_sums();
    if (sums_regions) row.regions = regions(true);
    if (request.numbers)
        row.numbers = finish(sums_, sums_.surfaces.origin, self_ != 0);
    else
        row.numbers.volume = sums_.volume([](const auto& totals) { return totals.volume; }, self_ ? 12 : 6);
    if (request.numbers) row.numbers.contact_area = contact_area();
    if (self_) row.exists = row.numbers.volume.scaled.mantissa != 0;
    if (!row.exists) return row;
    if (std::abs(row.numbers.volume.value) < request.min_volume) return row;
    row.relation = relate(row.numbers);
    for (std::size_t side = 0; side < (self_ ? 1 : 2); ++side) {
        if (request.gradient) row.gradient[side] = gradient(side);
        if (request.windings) row.windings[side] = windings(side);
    }
    if (request.unions && !self_) add_unions(request.orientations, row);
    if (self_) return row;
    if (has_regions && !sums_regions) row.regions = regions(false);
    if (request.extents) row.extent = extent(row.numbers.normal);
    if (request.curves) row.curves = curves(row.numbers.point);
    return row;
}

// Decides how each pair crosses, in parallel chunks.
void OverlapOfBodies::cross_pairs(bool gradient) {
    constexpr std::size_t chunk = 1024;
    std::vector<CrossedPairs> parts((pairs_.size() + chunk - 1) / chunk);
    const bool quick = in_range();
    const auto on_device = sums_.on_device.crossings;
    const int once = self_ == 0 ? 1 : 0;  // a body with itself has no curves
    const auto cross = [&](std::size_t part) {
        cancellation_.check();
        CrossedPairs& crossed = parts[part];
        bool summed = false;  // true if a device has summed the terms of the current pair
        const auto add = [&](const Pair& pair, const DecidedCrossing& crossing, Shift shift, int times) {
            if (!crosses(crossing.jumps)) return;
            const bool forward = shift == Shift::forward;
            auto& steps = crossed.steps[forward ? 0 : 1];
            steps[0].add_jumps(topology(0), pair.a, crossing.jumps.a);
            steps[1].add_jumps(topology(1), pair.b, crossing.jumps.b);
            crossed.meet = true;
            if (!crossing.jumps.segment && forward) add_link(pair, crossing.jumps, crossed.links);
            if (!crossing.jumps.segment || (times == 0 && !forward)) return;
            Segment segment = crossing.segment;
            segment.a = pair.a, segment.b = pair.b;
            segment.in_volume = forward;
            segment.times = static_cast<std::int8_t>(times);
            segment.summed = summed;
            crossed.segments.push_back(segment);
        };
        const auto add_pair = [&](const Pair& pair, const DecidedCrossings& both) {
            add(pair, both.forward, Shift::forward, once * times_in_curves(both.tied));
            if (both.tied || gradient) add(pair, both.backward, Shift::backward, both.tied ? once : 0);
            if (both.coplanar && (self_ == 0 || pair.a < pair.b)) crossed.coplanar.push_back(pair);
        };
        std::int32_t first = -1;
        std::optional<CrossedFace> face_a;  // face `first` of a, with which pairs come one after another
        const auto decide = [&](const Pair& pair) {
            if (!quick) return decide_crossings(body(0).corners(pair.a), body(1).corners(pair.b));
            if (pair.a != first) face_a.emplace(body(0).corners(first = pair.a));
            const CrossedFace face_b(body(1).corners(pair.b));
            FilteredCrossingSigns signs(*face_a, face_b);
            return decide_crossings(signs);
        };
        const auto some = pairs_.subspan(part * chunk, std::min(chunk, pairs_.size() - part * chunk));
        PairBlock block;
        CrossingSigns signs;
        for (std::size_t i = 0; i < some.size(); ++i) {
            if (!on_device.empty()) {
                const auto& decided = on_device[part * chunk + i];
                summed = !decided.uncertain();
                add_pair(some[i], decided.unpack());
                continue;
            }
            const std::size_t in_block = i % PairBlock::size;
            if (in_block == 0 && quick && kernels_) {
                fill(sums_.surfaces, some.subspan(i, std::min<std::size_t>(PairBlock::size, some.size() - i)), block);
                kernels_->find_signs(block, signs);
            }
            if (signs.apart >> in_block & 1) continue;
            if (signs.decided >> in_block & 1) {
                DecidedSigns known(signs, in_block);
                add_pair(some[i], decide_crossings(known));
            } else {
                add_pair(some[i], decide(some[i]));
            }
        }
    };
    MemoryClaim memory_of_parts(meter_);
    const auto cross_and_count = [&](std::size_t part) {
        cross(part);
        memory_of_parts.add(parts[part].bytes());
    };
    if (parts.size() == 1)
        cross_and_count(0);
    else
        workers_.parallel_for(parts.size(), cross_and_count);
    memory_.add(memory_of_parts.bytes());  // for the joined copies made below
    std::size_t count = 0;
    for (const CrossedPairs& part : parts) {
        count += part.segments.size();
        surfaces_meet_ |= part.meet;
    }
    if (!surfaces_meet_) surfaces_meet_ = some_pair_meets();
    sums_.segments.reserve(count);
    for (const CrossedPairs& part : parts) {
        sums_.segments.insert(sums_.segments.end(), part.segments.begin(), part.segments.end());
        links_.insert(links_.end(), part.links.begin(), part.links.end());
        coplanar_.insert(coplanar_.end(), part.coplanar.begin(), part.coplanar.end());
    }
    for (std::size_t s = 0; s < (gradient ? 2 : 1); ++s)
        for (std::size_t side = 0; side < 2; ++side)
            for (const CrossedPairs& part : parts) steps_[s][side].add(part.steps[s][side]);
}

// True if some pair of faces has a common point. Nearly always decided by the first pairs.
bool OverlapOfBodies::some_pair_meets() {
    constexpr std::size_t chunk = 64;
    std::atomic<bool> meet{false};
    workers_.parallel_for((pairs_.size() + chunk - 1) / chunk, [&](std::size_t part) {
        cancellation_.check();
        const std::size_t end = std::min(pairs_.size(), (part + 1) * chunk);
        for (std::size_t i = part * chunk; i < end && !meet.load(std::memory_order_relaxed); ++i)
            if (faces_meet(body(0).corners(pairs_[i].a), body(1).corners(pairs_[i].b))) meet = true;
    });
    return meet;
}

void OverlapOfBodies::find_windings(bool gradient) {
    for (std::size_t s = 0; s < (gradient ? 2 : 1); ++s)
        for (std::size_t side = 0; side < 2; ++side) {
            const Shift of_second = both_shifts[s];
            steps_[s][side].add_components(body(side), body(1 - side), side == 0 ? of_second : opposite(of_second),
                                           cancellation_);
            steps_[s][side].make_intervals();
        }
}

double OverlapOfBodies::contact_area() {
    const ContactArea contact = find_contact_area(sums_.surfaces, coplanar_, workers_, cancellation_, meter_);
    was_exact_ |= contact.was_exact;
    return contact.area;
}

// Counts each face as often as the winding number at its first corner, plus the jumps where its edge 01 is crossed.
void OverlapOfBodies::count_faces() {
    for (std::size_t side = 0; side < 2; ++side) {
        auto& faces = sums_.faces[side];
        for (const WindingInterval& interval : steps(side).intervals())
            for (const std::int32_t face : topology(side).faces(interval.begin, interval.end))
                faces.push_back({face, interval.winding});
    }
    for (const Segment& segment : sums_.segments)
        if (segment.in_volume) count_crossed_faces(segment, sums_.faces);
    // For a body with itself, whose overlap is ½ ∫ (w² − w) dx, subtracts the term of w: each face once.
    for (std::int32_t face = 0; self_ != 0 && face < topology(0).face_count(); ++face)
        sums_.faces[0].push_back({face, -self_});
    for (const auto& faces : sums_.faces) memory_.add(bytes_of(faces));
}

void OverlapOfBodies::count_crossed_faces(const Segment& segment, std::array<std::vector<CountedFace>, 2>& faces) {
    for (const SegmentEnd& end : {segment.start, segment.end})
        if (end.edge == 0) faces[end.side].push_back({end.side == 0 ? segment.a : segment.b, end.jump});
}

OverlapSums OverlapOfBodies::sums_of_surfaces() const {
    OverlapSums sums(workers_, kernels_, cancellation_);
    sums.surfaces = sums_.surfaces;
    sums.on_device.device = sums_.on_device.device;
    sums.on_device.surface = sums_.on_device.surface;
    sums.numbers = false;
    return sums;
}

void OverlapOfBodies::add_depths(const OverlapQuery& query, const std::array<const SurfaceTree*, 2>& tree,
                                 OverlapRow& row) {
    std::int64_t rational = 0;
    std::array<DepthSide, 2> sides{};
    std::array<std::vector<VertexDepth>, 2> depths;
    MemoryClaim memory(meter_);
    for (std::size_t side = 0; side < 2; ++side) {
        depths[side] = find_depths(body(side), steps(side), *tree[1 - side], workers_, cancellation_, rational);
        memory.add(bytes_of(depths[side]));
        sides[side] = {&body(side), &steps(side), depths[side], tree[side]};
    }
    if (query.depth_tolerance > 0)
        row.depth_bounds = find_depth_bounds(sides, pairs_, query.depth_tolerance, workers_, meter_, cancellation_);
    was_exact_ |= rational != 0;
    if (query.depths) row.depths = std::move(depths);
}

std::vector<VertexWinding> OverlapOfBodies::inside_vertices(std::size_t side) const {
    std::vector<VertexWinding> found;
    std::size_t count = 0;
    for (const WindingInterval& i : steps(side).intervals()) count += static_cast<std::size_t>(i.end - i.begin);
    found.reserve(count);
    for (const WindingInterval& interval : steps(side).intervals())
        for (std::int32_t place = interval.begin; place < interval.end; ++place)
            found.push_back({topology(side).vertex_at_place(place), interval.winding});
    return found;
}

std::vector<VertexWinding> OverlapOfBodies::windings(std::size_t side) const {
    std::vector<VertexWinding> found = inside_vertices(side);
    std::sort(found.begin(), found.end(), [](const auto& x, const auto& y) { return x.vertex < y.vertex; });
    return found;
}

}  // namespace crumple
