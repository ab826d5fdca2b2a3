#include "search/overlap_row.h"

#include <algorithm>
#include <optional>

#include "exact/overlap/pair_terms.h"
#include "exact/overlap/quick_crossing.h"
#include "exact/overlap/rational_crossing.h"
#include "exact/overlap/rational_sum.h"

namespace crumple {
namespace {

/// Adds what a face or a pair of faces does to the sums of its row.
template <class Sum, class Number>
void add(const VolumeTerms<Number>& terms, OverlapTotals<Sum>& totals) {
    totals.volume.add(terms.volume);
    for (int axis = 0; axis < 3; ++axis) totals.moment[static_cast<std::size_t>(axis)].add(terms.moment[axis]);
}
template <class Sum, class Number>
void add(const CurveTerms<Number>& terms, OverlapTotals<Sum>& totals) {
    for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        totals.area[k].add(terms.area[axis]);
        totals.torque[k].add(terms.torque[axis]);
    }
}

PlacedFace<Enclosed> placed(const FaceCorners& p, const Vec3<Enclosed>& normal, const Vec3d& origin) {
    return {{enclosed_difference(p[0], origin), enclosed_difference(p[1], origin), enclosed_difference(p[2], origin)},
            normal};
}
PlacedFace<Rational> placed_rationally(const FaceCorners& p, const Vec3d& origin) {
    const auto from_origin = [&](const Vec3d& q) {
        return Vec3<Rational>{Rational(q.x) - Rational(origin.x), Rational(q.y) - Rational(origin.y),
                              Rational(q.z) - Rational(origin.z)};
    };
    PlacedFace<Rational> face{{from_origin(p[0]), from_origin(p[1]), from_origin(p[2])}, {}};
    face.normal = cross(face.corner[1] - face.corner[0], face.corner[2] - face.corner[0]);
    return face;
}

template <class Number>
CurveTerms<Number> curve(const PlacedFace<Number>& a, const Crossing<Number>& crossing) {
    CurveTerms<Number> terms;
    terms.add(a.at(crossing.start_in_a), a.at(crossing.end_in_a));
    return terms;
}

/// Returns the share of a face in the winding number of its surface, which is shifted, at p: by filters and expansions.
int quick_winding_along_ray(const Vec3d& p, const FaceCorners& face, Shift shift) {
    const int along = orient2d(face[0], face[1], face[2], 0);
    if (along == 0) return 0;
    const auto sign = [](double x, double y) { return (x > y) - (x < y); };
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3d &q = face[i], &q_end = face[next_corner(i)];
        int turn = p == q || p == q_end ? 0 : orient2d(q, q_end, p, 0);
        if (turn == 0) {
            const int z = sign(q_end.z, q.z);
            turn = sign_of(shift) * (z != 0 ? z : sign(q.y, q_end.y));
        }
        if (turn != along) return 0;
    }
    const bool corner = p == face[0] || p == face[1] || p == face[2];
    int side = corner ? 0 : orient3d(face[0], face[1], face[2], p);
    if (side == 0) side = -sign_of(shift) * along;
    return side == -along ? along : 0;
}

bool misses_ray(const Vec3d& p, const FaceCorners& face) {
    if (max(face[0].x, max(face[1].x, face[2].x)) < p.x) return true;
    for (int axis = 1; axis < 3; ++axis) {
        if (min(face[0][axis], min(face[1][axis], face[2][axis])) > p[axis]) return true;
        if (max(face[0][axis], max(face[1][axis], face[2][axis])) < p[axis]) return true;
    }
    return false;
}

/// In the unit that is common to both.
struct CommonUnit {
    int exponent;
    CommonUnit(const FaceCorners& p, const FaceCorners& q) {
        const std::array corners{p[0], p[1], p[2], q[0], q[1], q[2]};
        exponent = common_exponent(corners);
    }
    IntegerTriangle operator()(const FaceCorners& p) const {
        return {scaled(p[0], exponent), scaled(p[1], exponent), scaled(p[2], exponent)};
    }
};

RationalCrossing cross_rationally(const FaceCorners& a, const FaceCorners& b, Shift shift) {
    const CommonUnit unit(a, b);
    return cross_rationally(unit(a), unit(b), shift);
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

void WindingSteps::add_jump(const ClosedSurface& surface, std::int32_t face, std::size_t edge, int jump) {
    const int direction = surface.forest_edge(face, edge);
    if (direction == 0 || jump == 0) return;
    const std::int32_t* c = surface.corners(face);
    const std::int32_t place = surface.place(c[direction > 0 ? next_corner(edge) : edge]);
    add(place, surface.end_of(place), direction * jump);
}

void WindingSteps::finish() {
    std::sort(steps_.begin(), steps_.end());
    intervals_.clear();
    std::int32_t winding = 0;
    for (std::size_t i = 0; i < steps_.size();) {
        const std::int32_t place = steps_[i].place;
        if (winding != 0) intervals_.back().end = place;
        for (; i < steps_.size() && steps_[i].place == place; ++i) winding += steps_[i].change;
        if (winding != 0) intervals_.push_back({place, place, winding});
    }
}

OverlapRow OverlapOfBodies::find(const PlacedSurface& a, const PlacedSurface& b, std::span<const Pair> pairs,
                                 const Vec3d& origin) {
    origin_ = origin;
    OverlapRow row;
    bool known = false;
    if (a.in_range && b.in_range) {
        begin();
        quick_ = {};
        add_quickly(a, b, pairs);
        find_windings(a, b);
        row.exists = !pairs.empty() || !of_a_.intervals().empty() || !of_b_.intervals().empty();
        if (!row.exists) return row;
        add_inside(a, of_a_);
        add_inside(b, of_b_);
        known = finish(
            quick_, origin, [](const FixedSum& sum, int by) { return sum.rounded_quotient(by); }, row.numbers);
    }
    if (!known) {
        ++rational_rows_;
        const OverlapTotals<RationalSum> totals = add_rationally(a, b, pairs);
        row.exists = !pairs.empty() || !of_a_.intervals().empty() || !of_b_.intervals().empty();
        const auto round = [&](const RationalSum& sum, int divisor) {
            return std::optional(sum.rounded_quotient(divisor, cancellation_));
        };
        finish(totals, origin, round, row.numbers);
    }
    row.relation = relate(a, b, pairs, row.numbers);
    return row;
}

void OverlapOfBodies::begin() {
    crossings_ = false;
    of_a_.clear();
    of_b_.clear();
}

void OverlapOfBodies::find_windings(const PlacedSurface& a, const PlacedSurface& b) {
    add_components(a, b, Shift::forward, of_a_);
    add_components(b, a, Shift::backward, of_b_);
    of_a_.finish();
    of_b_.finish();
}

void OverlapOfBodies::add_jumps(const PlacedSurface& a, const PlacedSurface& b, const Pair& pair,
                                const FaceCrossing& jumps) {
    for (std::size_t k = 0; k < 3; ++k) {
        of_a_.add_jump(*a.surface, pair.a, k, jumps.a[k]);
        of_b_.add_jump(*b.surface, pair.b, k, jumps.b[k]);
    }
}

void OverlapOfBodies::add_quickly(const PlacedSurface& a, const PlacedSurface& b, std::span<const Pair> pairs) {
    for (std::size_t i = 0; i < pairs.size();) {
        cancellation_.check();
        const std::int32_t face_a = pairs[i].a;
        const CrossedFace crossed_a(a.corners(face_a));
        const PlacedFace<Enclosed> placed_a = placed(crossed_a.corner, crossed_a.normal(), origin_);
        for (; i < pairs.size() && pairs[i].a == face_a; ++i) {
            const CrossedFace crossed_b(b.corners(pairs[i].b));
            const QuickCrossing crossing = cross_certainly(crossed_a, crossed_b, Shift::forward);
            add_jumps(a, b, pairs[i], crossing.jumps);
            if (crossing.jumps.segment) {
                crossings_ = true;
                VolumeTerms<Enclosed> terms;
                terms.add(placed_a, crossing.a);
                terms.add(placed(crossed_b.corner, crossed_b.normal(), origin_), crossing.b);
                add(terms, quick_);
                const CurveTerms<Enclosed> segment = curve(placed_a, crossing);
                add(segment, quick_);
                if (!crossing.tied) add(segment, quick_);
            }
            if (!crossing.tied) continue;
            const QuickCrossing other = cross_certainly(crossed_a, crossed_b, Shift::backward);
            if (other.jumps.segment) add(curve(placed_a, other), quick_);
        }
    }
}

void OverlapOfBodies::add_components(const PlacedSurface& of, const PlacedSurface& other, Shift shift,
                                     WindingSteps& steps) {
    const auto& first = of.surface->components();
    const bool quick = of.in_range && other.in_range;
    for (std::size_t c = 0; c + 1 < first.size(); ++c) {
        const Vec3d p = of.points[of.surface->vertex_at(first[c])];
        if (!overlap(Bounds{p, p}, other.box)) continue;
        cancellation_.check();
        std::int32_t winding = 0;
        for (const std::int32_t f : other.surface->faces(0, other.surface->places())) {
            const FaceCorners face = other.corners(f);
            if (misses_ray(p, face)) continue;
            const CommonUnit unit({p, p, p}, face);
            winding += quick ? quick_winding_along_ray(p, face, shift)
                             : winding_along_ray(scaled(p, unit.exponent), unit(face), shift);
        }
        steps.add(first[c], first[c + 1], winding);
    }
}

void OverlapOfBodies::add_inside(const PlacedSurface& of, const WindingSteps& steps) {
    for (const WindingInterval& interval : steps.intervals()) {
        cancellation_.check();
        for (const std::int32_t face : of.surface->faces(interval.begin, interval.end)) {
            VolumeTerms<Enclosed> terms;
            const FaceCorners p = of.corners(face);
            terms.add(placed(p, CrossedFace(p).normal(), origin_), interval.winding);
            add(terms, quick_);
        }
    }
}

OverlapTotals<RationalSum> OverlapOfBodies::add_rationally(const PlacedSurface& a, const PlacedSurface& b,
                                                           std::span<const Pair> pairs) {
    begin();
    OverlapTotals<RationalSum> totals;
    std::unordered_map<std::int32_t, FaceWeights<Rational>> on_a, on_b;
    for (const Pair& pair : pairs) {
        cancellation_.check();
        const FaceCorners p = a.corners(pair.a), q = b.corners(pair.b);
        const PlacedFace<Rational> placed_a = placed_rationally(p, origin_);
        for (const Shift shift : {Shift::forward, Shift::backward}) {
            const RationalCrossing crossing = cross_rationally(p, q, shift);
            if (shift == Shift::forward) add_jumps(a, b, pair, crossing.jumps);
            if (!crossing.jumps.segment) continue;
            crossings_ = true;
            add(curve(placed_a, crossing), totals);
            for (std::size_t k = 0; k < 3 && shift == Shift::forward; ++k) {
                on_a[pair.a][k] += crossing.a[k];
                on_b[pair.b][k] += crossing.b[k];
            }
        }
    }
    find_windings(a, b);
    const auto add_faces = [&](const PlacedSurface& of, const WindingSteps& steps, auto& weights) {
        for (const WindingInterval& interval : steps.intervals())
            for (const std::int32_t face : of.surface->faces(interval.begin, interval.end))
                for (Rational& weight : weights[face]) weight += interval.winding;
        for (const auto& [face, weight] : weights) {
            cancellation_.check();
            VolumeTerms<Rational> terms;
            terms.add(placed_rationally(of.corners(face), origin_), weight);
            add(terms, totals);
        }
    };
    add_faces(a, of_a_, on_a);
    add_faces(b, of_b_, on_b);
    return totals;
}

namespace {

/// Between which numbers six times the volume of a body lies.
struct VolumeBounds {
    double low = 0, high = 0;
};
VolumeBounds bounds_of_volume(const PlacedSurface& body, const Vec3d& origin) {
    double sum = 0, magnitude = 0;
    for (const std::int32_t f : body.surface->faces(0, body.surface->places())) {
        const FaceCorners p = body.corners(f);
        const Vec3d x = p[0] - origin, y = p[1] - origin, z = p[2] - origin;
        sum += dot(x, cross(y, z));
        const Vec3d size_x = abs(x), size_y = abs(y), size_z = abs(z);
        magnitude += size_x.x * (size_y.y * size_z.z + size_y.z * size_z.y) +
                     size_x.y * (size_y.z * size_z.x + size_y.x * size_z.z) +
                     size_x.z * (size_y.x * size_z.y + size_y.y * size_z.x);
    }
    // A term passes eight roundings at most, and each sum as many as there are faces.
    const double faces = static_cast<double>(body.surface->faces(0, body.surface->places()).size());
    const double error = 0x1p-52 * (faces + 16) * magnitude;
    return {sum - error, sum + error};
}

Rational six_volumes_of(const PlacedSurface& body) {
    const auto faces = body.surface->faces(0, body.surface->places());
    int exponent = 0;
    for (const std::int32_t f : faces) {
        const FaceCorners p = body.corners(f);
        exponent = std::min(exponent, common_exponent(p));
    }
    Integer total = 0;
    for (const std::int32_t f : faces) {
        const FaceCorners p = body.corners(f);
        total += dot(scaled(p[0], exponent), cross(scaled(p[1], exponent), scaled(p[2], exponent)));
    }
    return Rational(mp::cpp_int(total), mp::cpp_int(1) << (-3 * exponent));
}

}  // namespace

// True if all of a body lies where the winding number of the other is 1 or -1, and nothing of the other lies in it:
// then its volume is that of the overlap.
bool OverlapOfBodies::is_inside(const PlacedSurface& of, const WindingSteps& steps, const WindingSteps& others) const {
    const auto& intervals = steps.intervals();
    return !crossings_ && others.intervals().empty() && intervals.size() == 1 && std::abs(intervals[0].winding) == 1 &&
           intervals[0].begin == 0 && intervals[0].end == of.surface->places();
}

OverlapRelation OverlapOfBodies::relate(const PlacedSurface& a, const PlacedSurface& b, std::span<const Pair> pairs,
                                        const OverlapNumbers& numbers) {
    const Scaled& volume = numbers.volume.scaled;
    if (volume.mantissa == 0) return pairs.empty() ? OverlapRelation::overlapping : OverlapRelation::touching;
    std::optional<OverlapTotals<RationalSum>> exact;
    const auto has_that_volume = [&](const PlacedSurface& body) {
        if (a.in_range && b.in_range) {
            const VolumeBounds own = bounds_of_volume(body, origin_);
            const double size = 6 * std::abs(volume.value());
            const double least = std::max(std::max(own.low, -own.high), 0.0), most = std::max(own.high, -own.low);
            if (size * (1 + 0x1p-50) < least || size * (1 - 0x1p-50) > most) return false;
        }
        if (!exact) exact = add_rationally(a, b, pairs);
        const Rational six = six_volumes_of(body);
        for (const int sign : {1, -1}) {
            RationalSum difference;
            difference.add_product(exact->volume, 1);
            difference.add(Rational(3 * sign) * six);
            if (difference.rounded_quotient(1, cancellation_).scaled.mantissa == 0) return true;
        }
        return false;
    };
    const bool first = is_inside(a, of_a_, of_b_) || has_that_volume(a);
    const bool second = is_inside(b, of_b_, of_a_) || has_that_volume(b);
    if (first && second) return OverlapRelation::equal;
    if (first) return OverlapRelation::first_inside;
    return second ? OverlapRelation::second_inside : OverlapRelation::overlapping;
}

}  // namespace crumple
