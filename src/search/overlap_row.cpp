#include "search/overlap_row.h"

#include <algorithm>
#include <cmath>

#include "exact/overlap/pair_terms.h"
#include "exact/overlap/quick_crossing.h"
#include "exact/overlap/rational_crossing.h"
#include "search/overlap_placed.h"

namespace crumple {
namespace {

std::size_t index_of(Shift shift) { return shift == Shift::forward ? 0 : 1; }

template <class Sum, class Number>
void add_vector(const Vec3<Number>& vector, std::array<Sum, 3>& sums) {
    for (int axis = 0; axis < 3; ++axis) sums[static_cast<std::size_t>(axis)].add(vector[axis]);
}
template <class Sum, class Number>
void add(const CurveTerms<Number>& terms, OverlapTotals<Sum>& totals) {
    add_vector(terms.area, totals.area);
    add_vector(terms.torque, totals.torque);
}

template <class Number>
CurveTerms<Number> curve(const PlacedFace<Number>& a, const Crossing<Number>& crossing) {
    CurveTerms<Number> terms;
    terms.add(a.at(crossing.start_in_a), a.at(crossing.end_in_a));
    return terms;
}

Enclosed enclosed(const Rational& x) {
    const auto high = x.convert_to<double>();
    const Rational rest = x - Rational(high);
    const auto low = rest.convert_to<double>();
    const Rational beyond = abs(rest - Rational(low));
    const TwoTerms value = two_sum(high, low);
    return {value, beyond == 0 ? 0 : (1 + 0x1p-40) * beyond.convert_to<double>() + 0x1p-1070};
}
PointInFace<Enclosed> enclosed(const PointInFace<Rational>& p) { return {enclosed(p.u), enclosed(p.v)}; }
FaceWeights<Enclosed> enclosed(const FaceWeights<Rational>& w) {
    return {enclosed(w[0]), enclosed(w[1]), enclosed(w[2])};
}

/// With numbers that are certain.
QuickCrossing cross_certainly(const CrossedFace& a, const CrossedFace& b, Shift shift) {
    QuickCrossing crossing = cross_quickly(a, b, shift);
    if (crossing.certain) return crossing;
    const RationalCrossing exact = cross_rationally(a.corner, b.corner, shift);
    crossing.start_in_a = enclosed(exact.start_in_a);
    crossing.end_in_a = enclosed(exact.end_in_a);
    crossing.a = enclosed(exact.a);
    crossing.b = enclosed(exact.b);
    return crossing;
}

}  // namespace

OverlapRow OverlapOfBodies::find(const PlacedSurface& a, const PlacedSurface& b, std::span<const Pair> pairs,
                                 const Vec3d& origin, const Request& request) {
    surfaces_ = {&a, &b};
    pairs_ = pairs;
    origin_ = origin;
    self_ = 0;
    return find(request);
}

OverlapRow OverlapOfBodies::find_self(const PlacedSurface& body, std::span<const Pair> pairs, const Vec3d& origin,
                                      const Request& request) {
    surfaces_ = {&body, &body};
    pairs_ = pairs;
    origin_ = origin;
    self_ = request.orientation;
    return find(request);
}

OverlapRow OverlapOfBodies::find(const Request& request) {
    exact_.reset();
    numbers_ = request.numbers;
    crossings_ = false;
    OverlapRow row;
    bool known = false;
    const auto exists = [&] {
        return !pairs_.empty() || !steps(0).intervals().empty() || !steps(1).intervals().empty();
    };
    if (in_range()) {
        add_quickly(request);
        row.exists = exists();
        if (!row.exists) return row;
        add_faces(quick_[0], quick_totals_, [&](const FaceCorners& p) { return placed_quickly(p, origin_); });
        const auto round = [](const FixedSum& sum, int by) { return sum.rounded_quotient(by); };
        known = finish(quick_totals_, round, row.numbers);
    }
    if (!known) {
        const OverlapTotals<RationalSum>& totals = exact_overlap().totals;
        row.exists = exists();
        const auto round = [&](const RationalSum& sum, int by) {
            return std::optional(sum.rounded_quotient(by, cancellation_));
        };
        finish(totals, round, row.numbers);
    }
    if (self_) row.exists = row.numbers.volume.scaled.mantissa != 0;
    if (!row.exists) return row;
    row.relation = relate(row.numbers);
    for (std::size_t side = 0; side < (self_ ? 1 : 2); ++side) {
        if (request.gradient) row.gradient[side] = gradient(side);
        if (request.windings) row.windings[side] = windings(side);
    }
    return row;
}

template <class Sum, class Round>
bool OverlapOfBodies::finish(const OverlapTotals<Sum>& totals, Round round, OverlapNumbers& numbers) const {
    if (numbers_) return crumple::finish(totals, origin_, self_ != 0, round, numbers);
    const auto volume = round(totals.volume, self_ != 0 ? 36 : 18);
    if (volume) numbers.volume = *volume;
    return volume.has_value();
}

template <class Number>
void OverlapOfBodies::add_jumps(const Pair& pair, const FaceCrossing& jumps, ShiftedSurfaces<Number>& surfaces) const {
    surfaces[0].steps.add_jumps(topology(0), pair.a, jumps.a);
    surfaces[1].steps.add_jumps(topology(1), pair.b, jumps.b);
}

template <class Number>
void OverlapOfBodies::add_windings(Shift shift, ShiftedSurfaces<Number>& surfaces) const {
    for (std::size_t side = 0; side < 2; ++side) {
        ShiftedSurface<Number>& surface = surfaces[side];
        surface.steps.add_components(*surfaces_[side], *surfaces_[1 - side], side == 0 ? shift : opposite(shift),
                                     cancellation_);
        surface.steps.finish();
        surface.weights.combine();
        surface.weights.add_windings(topology(side), surface.steps);
    }
}

void OverlapOfBodies::add_quickly(const Request& request) {
    quick_totals_ = {};
    for (auto& surfaces : quick_)
        for (auto& surface : surfaces) surface.clear();
    const auto add_crossing = [&](const Pair& pair, const QuickCrossing& crossing, Shift shift) {
        ShiftedSurfaces<Enclosed>& surfaces = quick_[index_of(shift)];
        add_jumps(pair, crossing.jumps, surfaces);
        if (!crossing.jumps.segment) return;
        surfaces[0].weights.add(pair.a, crossing.a);
        surfaces[1].weights.add(pair.b, crossing.b);
    };
    for (std::size_t i = 0; i < pairs_.size();) {
        cancellation_.check();
        const std::int32_t face_a = pairs_[i].a;
        const CrossedFace a(surfaces_[0]->corners(face_a));
        const PlacedFace<Enclosed> placed_a = placed_quickly(a.corner, origin_);
        for (; i < pairs_.size() && pairs_[i].a == face_a; ++i) {
            const CrossedFace b(surfaces_[1]->corners(pairs_[i].b));
            const QuickCrossing crossing = cross_certainly(a, b, Shift::forward);
            const QuickCrossing other = crossing.tied ? cross_certainly(a, b, Shift::backward) : crossing;
            crossings_ = crossings_ || crossing.jumps.segment;
            add_crossing(pairs_[i], crossing, Shift::forward);
            if (request.gradient) add_crossing(pairs_[i], other, Shift::backward);
            for (const QuickCrossing* one : {&crossing, &other})
                if (one->jumps.segment && self_ == 0 && numbers_) add(curve(placed_a, *one), quick_totals_);
        }
    }
    add_windings(Shift::forward, quick_[0]);
    if (request.gradient) add_windings(Shift::backward, quick_[1]);
}

template <class Number, class Sum, class Place>
void OverlapOfBodies::add_faces(ShiftedSurfaces<Number>& surfaces, OverlapTotals<Sum>& totals, Place place) const {
    const auto add_face = [&](std::size_t side, std::int32_t face, const auto& weights) {
        cancellation_.check();
        VolumeTerms<Number> terms;
        terms.add(place(surfaces_[side]->corners(face)), weights, numbers_);
        totals.volume.add(terms.volume);
        if (numbers_) add_vector(terms.moment, totals.moment);
    };
    for (std::size_t side = 0; side < 2; ++side) {
        const auto add_one = [&](std::int32_t face, const auto& weights) { add_face(side, face, weights); };
        surfaces[side].weights.for_each(topology(side), surfaces[side].steps, add_one, add_one);
    }
    if (self_ == 0) return;
    // The winding number itself, of the whole surface.
    for (std::int32_t face = 0; face < topology(0).face_count(); ++face) add_face(0, face, -self_);
}

const OverlapOfBodies::ExactOverlap& OverlapOfBodies::exact_overlap() {
    if (exact_) return *exact_;
    ++rational_rows_;
    exact_.emplace();
    for (const Pair& pair : pairs_) {
        cancellation_.check();
        const FaceCorners p = surfaces_[0]->corners(pair.a), q = surfaces_[1]->corners(pair.b);
        for (const Shift shift : both_shifts) {
            ShiftedSurfaces<Rational>& surfaces = exact_->shifted[index_of(shift)];
            const RationalCrossing crossing = cross_rationally(p, q, shift);
            add_jumps(pair, crossing.jumps, surfaces);
            if (!crossing.jumps.segment) continue;
            crossings_ = true;
            surfaces[0].weights.add(pair.a, crossing.a);
            surfaces[1].weights.add(pair.b, crossing.b);
            if (self_ == 0 && numbers_) add(curve(placed_rationally(p, origin_), crossing), exact_->totals);
        }
    }
    for (const Shift shift : both_shifts) add_windings(shift, exact_->shifted[index_of(shift)]);
    add_faces(exact_->shifted[0], exact_->totals, [&](const FaceCorners& p) { return placed_rationally(p, origin_); });
    return *exact_;
}

const WindingSteps& OverlapOfBodies::steps(std::size_t side) const {
    return in_range() ? quick_[0][side].steps : exact_->shifted[0][side].steps;
}

// True if all of a body lies where the winding number of the other is 1 or -1, and nothing of the other lies in it:
// then its volume is that of the overlap.
bool OverlapOfBodies::is_inside(std::size_t side) const {
    const auto& intervals = steps(side).intervals();
    return !crossings_ && steps(1 - side).intervals().empty() && intervals.size() == 1 &&
           std::abs(intervals[0].winding) == 1 && intervals[0].begin == 0 &&
           intervals[0].end == topology(side).places();
}

OverlapRelation OverlapOfBodies::relate(const OverlapNumbers& numbers) {
    const Scaled& volume = numbers.volume.scaled;
    if (self_) return OverlapRelation::overlapping;
    if (volume.mantissa == 0) return pairs_.empty() ? OverlapRelation::overlapping : OverlapRelation::touching;
    const auto has_that_volume = [&](std::size_t side) {
        const PlacedSurface& body = *surfaces_[side];
        if (is_inside(side)) return true;
        if (in_range()) {
            const VolumeBounds own = bounds_of_volume(body, origin_);
            const double size = 6 * std::abs(volume.value());
            const double least = std::max(std::max(own.low, -own.high), 0.0), most = std::max(own.high, -own.low);
            if (size * (1 + 0x1p-50) < least || size * (1 - 0x1p-50) > most) return false;
        }
        const Rational six = six_volumes_of(body);
        for (const int sign : {1, -1}) {
            RationalSum difference;
            difference.add_product(exact_overlap().totals.volume, 1);
            difference.add(Rational(3 * sign) * six);
            if (difference.rounded_quotient(1, cancellation_).scaled.mantissa == 0) return true;
        }
        return false;
    };
    const bool first = has_that_volume(0), second = has_that_volume(1);
    if (first && second) return OverlapRelation::equal;
    if (first) return OverlapRelation::first_inside;
    return second ? OverlapRelation::second_inside : OverlapRelation::overlapping;
}

double OverlapOfBodies::volume_of(const PlacedSurface& body, const Vec3d& origin, int orientation) {
    if (body.in_range) {
        FixedSum sum;
        for (std::int32_t face = 0; face < body.surface->face_count(); ++face)
            sum.add(placed_quickly(body.corners(face), origin).cone());
        if (const auto rounded = sum.rounded_quotient(6)) return orientation * rounded->value + 0.0;
    }
    RationalSum sum;
    sum.add(six_volumes_of(body));
    return orientation * sum.rounded_quotient(6, cancellation_).value + 0.0;
}

std::vector<VertexWinding> OverlapOfBodies::windings(std::size_t side) const {
    std::vector<VertexWinding> found;
    for (const WindingInterval& interval : steps(side).intervals())
        for (std::int32_t place = interval.begin; place < interval.end; ++place)
            found.push_back({topology(side).vertex_at(place), interval.winding});
    std::sort(found.begin(), found.end(), [](const auto& x, const auto& y) { return x.vertex < y.vertex; });
    return found;
}

}  // namespace crumple
