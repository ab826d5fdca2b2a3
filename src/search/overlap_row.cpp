#include "search/overlap_row.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "exact/overlap/exact_crossing.h"
#include "exact/overlap/filtered_crossing.h"
#include "search/overlap_contact_area.h"
#include "search/overlap_volumes.h"

namespace crumple {
namespace {

/// Result for a chunk of triangle pairs: steps of winding numbers, segments and coplanar pairs.
struct CrossedPairs {
    std::array<std::array<WindingSteps, 2>, 2> steps;  ///< by shift (forward, backward) and by surface (first, second)
    std::vector<Segment> segments, links;
    std::vector<Pair> coplanar;

    std::size_t bytes() const {
        std::size_t bytes = bytes_of(segments) + bytes_of(links) + bytes_of(coplanar);
        for (const auto& shifted : steps)
            for (const WindingSteps& of_side : shifted) bytes += of_side.bytes();
        return bytes;
    }
};

/// Adds a segment without length if edges of a degenerate face cross the other face.
void add_link(const Pair& pair, const FaceCrossing& jumps, std::vector<Segment>& links) {
    const auto crosses = [](int jump) { return jump != 0; };
    if (std::none_of(jumps.a.begin(), jumps.a.end(), crosses) && std::none_of(jumps.b.begin(), jumps.b.end(), crosses))
        return;
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
    row.exists = !pairs.empty();
    row.relation = OverlapRelation::undefined;
    row.numbers = undefined_numbers(origin);
    if (!row.exists || !request.numbers) return row;
    cross_pairs(false);
    row.numbers.contact_area = contact_area();
    if (request.curves) row.curves = curves(origin);
    return row;
}

OverlapRow OverlapOfBodies::find(const Request& request) {
    sums_.numbers = request.numbers;
    cross_pairs(request.gradient);
    find_windings(request.gradient);
    OverlapRow row;
    row.exists = !pairs_.empty() || !steps(0).intervals().empty() || !steps(1).intervals().empty();
    if (!row.exists) return row;
    count_faces();
    if (request.numbers)
        row.numbers = finish(sums_, sums_.surfaces.origin, self_ != 0);
    else
        row.numbers.volume = sums_.volume([](const auto& totals) { return totals.volume; }, self_ ? 12 : 6);
    if (request.numbers) row.numbers.contact_area = contact_area();
    if (self_) row.exists = row.numbers.volume.scaled.mantissa != 0;
    if (!row.exists) return row;
    row.relation = relate(row.numbers);
    for (std::size_t side = 0; side < (self_ ? 1 : 2); ++side) {
        if (request.gradient) row.gradient[side] = gradient(side);
        if (request.windings) row.windings[side] = windings(side);
    }
    if (request.curves && !self_) row.curves = curves(row.numbers.point);
    return row;
}

// Decides how each pair crosses, in parallel chunks.
void OverlapOfBodies::cross_pairs(bool gradient) {
    constexpr std::size_t chunk = 1024;
    std::vector<CrossedPairs> parts((pairs_.size() + chunk - 1) / chunk);
    const bool quick = in_range();
    const int once = self_ == 0 ? 1 : 0;  // a body with itself has no curves
    const auto cross = [&](std::size_t part) {
        cancellation_.check();
        CrossedPairs& crossed = parts[part];
        const auto add = [&](const Pair& pair, const DecidedCrossing& crossing, Shift shift, int times) {
            const bool forward = shift == Shift::forward;
            auto& steps = crossed.steps[forward ? 0 : 1];
            steps[0].add_jumps(topology(0), pair.a, crossing.jumps.a);
            steps[1].add_jumps(topology(1), pair.b, crossing.jumps.b);
            if (!crossing.jumps.segment && forward) add_link(pair, crossing.jumps, crossed.links);
            if (!crossing.jumps.segment || (times == 0 && !forward)) return;
            Segment segment = crossing.segment;
            segment.a = pair.a, segment.b = pair.b;
            segment.in_volume = forward;
            segment.times = static_cast<std::int8_t>(times);
            crossed.segments.push_back(segment);
        };
        const auto add_pair = [&](const Pair& pair, const DecidedCrossings& both) {
            add(pair, both.forward, Shift::forward, both.tied ? once : 2 * once);
            if (both.tied || gradient) add(pair, both.backward, Shift::backward, both.tied ? once : 0);
            if (both.coplanar && (self_ == 0 || pair.a < pair.b)) crossed.coplanar.push_back(pair);
        };
        const std::size_t end = std::min(pairs_.size(), (part + 1) * chunk);
        std::optional<CrossedFace> a;
        for (std::size_t i = part * chunk; i < end; ++i) {
            const Pair& pair = pairs_[i];
            const FaceCorners p = body(0).corners(pair.a), q = body(1).corners(pair.b);
            if (!quick) {
                add_pair(pair, decide_crossings(p, q));
                continue;
            }
            if (i == part * chunk || pair.a != pairs_[i - 1].a) a.emplace(p);
            const CrossedFace b(q);
            FilteredCrossingSigns signs(*a, b);
            add_pair(pair, decide_crossings(signs));
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
    for (const CrossedPairs& part : parts) count += part.segments.size();
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
    const ContactArea contact = find_contact_area(sums_.surfaces, coplanar_, workers_, cancellation_);
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
        for (const Segment& segment : sums_.segments) {
            if (!segment.in_volume) continue;
            for (const SegmentEnd& end : {segment.start, segment.end})
                if (end.side == side && end.edge == 0) faces.push_back({side == 0 ? segment.a : segment.b, end.jump});
        }
    }
    // For a body with itself, whose overlap is ½ ∫ (w² − w) dx, subtracts the term of w: each face once.
    for (std::int32_t face = 0; self_ != 0 && face < topology(0).face_count(); ++face)
        sums_.faces[0].push_back({face, -self_});
    for (const auto& faces : sums_.faces) memory_.add(bytes_of(faces));
}

OverlapSums OverlapOfBodies::sums_of_surfaces() const {
    OverlapSums sums(workers_, kernels_, cancellation_);
    sums.surfaces = sums_.surfaces;
    sums.numbers = false;
    return sums;
}

// True if all of body `side` lies where the winding number of the other body is 1 or -1, and nothing of the other body
// lies in it. Then the overlap has the volume of body `side`.
bool OverlapOfBodies::is_inside(std::size_t side) const {
    const auto& intervals = steps(side).intervals();
    const auto is_forward = [](const Segment& segment) { return segment.in_volume; };
    return intervals.size() == 1 && std::abs(intervals[0].winding) == 1 && intervals[0].begin == 0 &&
           intervals[0].end == topology(side).places() && steps(1 - side).intervals().empty() &&
           std::none_of(sums_.segments.begin(), sums_.segments.end(), is_forward);
}

bool OverlapOfBodies::has_volume_of(std::size_t side, const Scaled& volume) {
    if (is_inside(side)) return true;
    int least_sign = -1, greatest_sign = 1;  // possible signs of the body's volume
    if (in_range()) {
        const VolumeBounds own = bounds_of_volume(body(side), sums_.surfaces.origin);
        const double size = 6 * std::abs(volume.value());
        const double least = std::max(std::max(own.low, -own.high), 0.0), most = std::max(own.high, -own.low);
        if (size * (1 + 0x1p-50) < least || size * (1 - 0x1p-50) > most) return false;
        if (own.low > 0) least_sign = 1;
        if (own.high < 0) greatest_sign = -1;
    }
    // Computes the difference between the overlap's volume and the body's volume, or its negative, as one sum, in which
    // most faces cancel.
    std::vector<std::int32_t> times(static_cast<std::size_t>(topology(side).face_count()));
    for (int sign = least_sign; sign <= greatest_sign; sign += 2) {
        OverlapSums difference = sums_of_surfaces();
        difference.segments = sums_.segments;
        difference.faces[1 - side] = sums_.faces[1 - side];
        std::fill(times.begin(), times.end(), (volume.mantissa > 0) == (sign > 0) ? -1 : 1);
        for (const CountedFace& face : sums_.faces[side]) times[static_cast<std::size_t>(face.face)] += face.times;
        for (std::size_t face = 0; face < times.size(); ++face)
            if (times[face] != 0) difference.faces[side].push_back({static_cast<std::int32_t>(face), times[face]});
        const RoundedSum six = difference.volume([](const auto& totals) { return totals.volume; }, 1);
        was_exact_ |= difference.was_exact();
        if (six.scaled.mantissa == 0) return true;
    }
    return false;
}

OverlapRelation OverlapOfBodies::relate(const OverlapNumbers& numbers) {
    const Scaled& volume = numbers.volume.scaled;
    if (self_) return OverlapRelation::overlapping;
    if (volume.mantissa == 0) return pairs_.empty() ? OverlapRelation::overlapping : OverlapRelation::touching;
    const bool first = has_volume_of(0, volume), second = has_volume_of(1, volume);
    if (first && second) return OverlapRelation::equal;
    if (first) return OverlapRelation::first_inside;
    return second ? OverlapRelation::second_inside : OverlapRelation::overlapping;
}

// Returns the volume of a body, for its overlap with itself: the integral of its winding number, correctly rounded.
double OverlapOfBodies::volume_of_body() {
    OverlapSums sums = sums_of_surfaces();
    for (std::int32_t face = 0; face < topology(0).face_count(); ++face) sums.faces[0].push_back({face, 1});
    const RoundedSum volume = sums.volume([](const auto& totals) { return totals.volume; }, 6);
    was_exact_ |= sums.was_exact();
    return self_ * volume.value + 0.0;
}

std::vector<VertexWinding> OverlapOfBodies::windings(std::size_t side) const {
    std::vector<VertexWinding> found;
    for (const WindingInterval& interval : steps(side).intervals())
        for (std::int32_t place = interval.begin; place < interval.end; ++place)
            found.push_back({topology(side).vertex_at_place(place), interval.winding});
    std::sort(found.begin(), found.end(), [](const auto& x, const auto& y) { return x.vertex < y.vertex; });
    return found;
}

}  // namespace crumple
