// Volumes of bodies, of their unions and differences, and the relation that follows from them.

#include <algorithm>
#include <cmath>

#include "search/overlap/overlap_row.h"
#include "search/overlap/overlap_volumes.h"

namespace crumple {

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
        const VolumeBounds own = bounds_of_volume(body(side));
        const double size = 6 * std::abs(volume.value());
        const double least = std::max(std::max(own.low, -own.high), 0.0), most = std::max(own.high, -own.low);
        if (size * (1 + 0x1p-50) < least || size * (1 - 0x1p-50) > most) return false;
        if (own.low > 0) least_sign = 1;
        if (own.high < 0) greatest_sign = -1;
    }
    // True if the overlap's volume minus the body's volume, or its negative, is 0.
    for (int sign = least_sign; sign <= greatest_sign; sign += 2) {
        std::array<int, 2> times{};
        times[side] = (volume.mantissa > 0) == (sign > 0) ? -1 : 1;
        if (volume_with(times).scaled.mantissa == 0) return true;
    }
    return false;
}

// Returns the overlap's volume plus times[side] times the volume of each body, as one sum, in which most faces cancel.
RoundedSum OverlapOfBodies::volume_with(const std::array<int, 2>& times) {
    OverlapSums sums = sums_of_surfaces();
    sums.segments = sums_.segments;
    for (std::size_t side = 0; side < 2; ++side) {
        if (times[side] == 0) {
            sums.faces[side] = sums_.faces[side];
            continue;
        }
        std::vector<std::int32_t> counts(static_cast<std::size_t>(topology(side).face_count()), times[side]);
        for (const CountedFace& face : sums_.faces[side]) counts[static_cast<std::size_t>(face.face)] += face.times;
        for (std::size_t face = 0; face < counts.size(); ++face)
            if (counts[face] != 0) sums.faces[side].push_back({static_cast<std::int32_t>(face), counts[face]});
    }
    const RoundedSum volume = sums.volume([](const auto& totals) { return totals.volume; }, 6);
    was_exact_ |= sums.was_exact();
    return volume;
}

// Signs are those of find(), before orient() turns mirrored bodies: with the orientations p and q of both bodies, whose
// volumes are then p a and q b, and that of their overlap p q v, the union is p a + q b − p q v = −p q (v − q a − p b).
void OverlapOfBodies::add_unions(const std::array<int, 2>& orientations, OverlapRow& row) {
    const int p = orientations[0], q = orientations[1];
    const auto negative = [&](const RoundedSum& sum) { return 0.0 - p * q * sum.value; };
    const RoundedSum both = volume_with({-q, -p});
    row.unions.volume = negative(both);
    if (both.scaled.mantissa != 0) row.unions.share = 0.0 - (row.numbers.volume.scaled / both.scaled).value();
    row.unions.difference = {negative(volume_with({-q, 0})), negative(volume_with({0, -p}))};
}

OverlapRelation OverlapOfBodies::relate(const OverlapNumbers& numbers) {
    const Scaled& volume = numbers.volume.scaled;
    if (self_) return OverlapRelation::overlapping;
    if (volume.mantissa == 0) return surfaces_meet_ ? OverlapRelation::touching : OverlapRelation::overlapping;
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

}  // namespace crumple
