#include "search/overlap_contact_area.h"

#include <algorithm>
#include <mutex>

#include "exact/overlap/common_area.h"
#include "exact/overlap/fixed_sum.h"
#include "exact/overlap/rational_sum.h"

namespace crumple {
namespace {

// An area is that of its projection along an axis, times the length of the normal over the normal's component along
// that axis. Sums hold twice the area.

struct EnclosedArea {
    Enclosed twice{0};

    void add(const Enclosed& x) { twice = twice + x; }
    void add_part(const Enclosed& x, const Enclosed& start, const Enclosed& end) {
        const bool whole = end.value.high == 0 && end.error == 0;
        add(whole ? x : x * (start / (start - end)));
    }
};

/// Adds up twice the areas of triangles whose coordinates are integers in units of 2^exponent.
struct ExactArea {
    RationalSum& twice;
    int exponent;

    void add(const Integer& x) { twice.add(x, 1, 2 * exponent); }
    void add_part(const Integer& x, const Integer& start, const Integer& end) {
        const Integer all = start - end, part = x * start;
        all < 0 ? twice.add(-part, -all, 2 * exponent) : twice.add(part, all, 2 * exponent);
    }
};

struct IntegerProjection {
    int axis;

    Integer value(const Vec3<Integer>& p, const Vec3<Integer>& q, const Vec3<Integer>& r) const {
        return cross(q - p, r - p)[axis];
    }
    int sign(const Vec3<Integer>& p, const Vec3<Integer>& q, const Vec3<Integer>& r) const {
        return value(p, q, r).sign();
    }
};

void add_enclosed(const FaceCorners& a, const FaceCorners& b, FixedSum& sum) {
    const int axis = FilteredPlane(a).dominant_axis(), x = first_axis(axis), y = second_axis(axis);
    EnclosedArea area;
    add_common_area(EnclosedProjection{axis}, a, b, area);
    if (area.twice.value.high == 0 && area.twice.error == 0) return;
    if (orient2d(a[0], a[1], a[2], x) != 0 || orient2d(a[0], a[1], a[2], y) != 0) {
        const Vec3<Enclosed> normal = cross(enclosed_difference(a[1], a[0]), enclosed_difference(a[2], a[0]));
        const Enclosed across = normal[axis].value.high < 0 ? -normal[axis] : normal[axis];
        area.twice = area.twice * (sqrt(dot(normal, normal)) / across);
    }
    sum.add(area.twice);
}

void add_exactly(const FaceCorners& a, const FaceCorners& b, RootSum& sum) {
    const int exponent = common_exponent(std::array{a[0], a[1], a[2], b[0], b[1], b[2]});
    const std::array<Vec3<Integer>, 3> p = in_units(a, exponent);
    const Vec3<Integer> normal = cross(p[1] - p[0], p[2] - p[0]);
    const int axis = normal.x != 0 ? 0 : normal.y != 0 ? 1 : 2;
    const auto wide = [](const Integer& x) { return Rational(mp::cpp_int(x)); };
    const Rational square = wide(dot(normal, normal)) / wide(normal[axis] * normal[axis]);
    ExactArea area{sum.times_root_of(square), exponent};
    add_common_area(IntegerProjection{axis}, p, in_units(b, exponent), area);
}

/// Adds up the common areas of pairs of faces, in parallel chunks. add(a, b, sum) adds the area of one pair.
template <class Sum, class Add>
Sum sum_of(const SurfacePair& surfaces, std::span<const Pair> pairs, ParallelFor& workers, Cancellation& cancellation,
           Add add) {
    constexpr std::size_t chunk = 256;
    Sum sum;
    std::mutex mutex;
    workers.parallel_for((pairs.size() + chunk - 1) / chunk, [&](std::size_t i) {
        Sum part;
        for (const Pair& pair : pairs.subspan(i * chunk, std::min(chunk, pairs.size() - i * chunk))) {
            cancellation.check();
            add(surfaces.corners(0, pair.a), surfaces.corners(1, pair.b), part);
        }
        const std::scoped_lock lock(mutex);
        sum.add(part);
    });
    return sum;
}

}  // namespace

ContactArea find_contact_area(const SurfacePair& surfaces, std::span<const Pair> pairs, ParallelFor& workers,
                              Cancellation& cancellation) {
    if (pairs.empty()) return {};
    if (surfaces.in_range()) {
        const auto sum = sum_of<FixedSum>(surfaces, pairs, workers, cancellation, add_enclosed);
        if (const auto known = sum.rounded_quotient(2)) return {known->value};
    }
    const auto sum = sum_of<RootSum>(surfaces, pairs, workers, cancellation, add_exactly);
    return {sum.rounded_quotient(2, cancellation).value, true};
}

}  // namespace crumple
