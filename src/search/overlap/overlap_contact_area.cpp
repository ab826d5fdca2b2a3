#include "search/overlap/overlap_contact_area.h"

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

/// A face, and the sum of the areas that it has in common with other faces in its plane.
class EnclosedContact {
   public:
    explicit EnclosedContact(const FaceCorners& face) : face_(face), axis_(FilteredPlane(face).dominant_axis()) {}

    void add(const FaceCorners& other) {
        if (overlaps_box(other, first_axis(axis_)) && overlaps_box(other, second_axis(axis_)))
            add_common_area(EnclosedProjection{axis_}, face_, other, area_);
    }

    /// Returns twice the sum of the areas.
    Enclosed twice() const {
        const auto &a = face_[0], &b = face_[1], &c = face_[2];
        const bool across = orient2d(a, b, c, first_axis(axis_)) == 0 && orient2d(a, b, c, second_axis(axis_)) == 0;
        if (across || (area_.twice.value.high == 0 && area_.twice.error == 0)) return area_.twice;
        const Vec3<Enclosed> normal = cross(enclosed_difference(b, a), enclosed_difference(c, a));
        const Enclosed along = normal[axis_].value.high < 0 ? -normal[axis_] : normal[axis_];
        return area_.twice * (sqrt(dot(normal, normal)) / along);
    }

   private:
    /// True if the interiors of the boxes of both faces overlap along an axis; otherwise the faces have no area in
    /// common.
    bool overlaps_box(const FaceCorners& other, int axis) const {
        const auto most = [&](const FaceCorners& f) { return std::max({f[0][axis], f[1][axis], f[2][axis]}); };
        const auto least = [&](const FaceCorners& f) { return std::min({f[0][axis], f[1][axis], f[2][axis]}); };
        return least(face_) < most(other) && least(other) < most(face_);
    }

    FaceCorners face_;
    int axis_;
    EnclosedArea area_;
};

/// Adds the common areas of all pairs to `sum`. Consecutive pairs with the same first face are summed together, so they
/// should be sorted by it.
void add_enclosed(const SurfacePair& surfaces, std::span<const Pair> pairs, FixedSum& sum) {
    for (std::size_t i = 0; i < pairs.size();) {
        const std::int32_t face = pairs[i].a;
        EnclosedContact contact(surfaces.corners(0, face));
        for (; i < pairs.size() && pairs[i].a == face; ++i) contact.add(surfaces.corners(1, pairs[i].b));
        sum.add(contact.twice());
    }
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

/// Adds up the common areas of pairs of faces, in parallel chunks. add(surfaces, pairs, sum) adds the areas of a
/// chunk's pairs to `sum`.
template <class Sum, class Add>
Sum sum_of(const SurfacePair& surfaces, std::span<const Pair> pairs, ParallelFor& workers, Cancellation& cancellation,
           Add add) {
    constexpr std::size_t chunk = 256;
    Sum sum;
    std::mutex mutex;
    workers.parallel_for((pairs.size() + chunk - 1) / chunk, [&](std::size_t i) {
        cancellation.check();
        Sum part;
        add(surfaces, pairs.subspan(i * chunk, std::min(chunk, pairs.size() - i * chunk)), part);
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
    const auto add_pairs = [&](const SurfacePair&, std::span<const Pair> some, RootSum& sum) {
        for (const Pair& pair : some) {
            cancellation.check();  // for each pair, because rational arithmetic is slow
            add_exactly(surfaces.corners(0, pair.a), surfaces.corners(1, pair.b), sum);
        }
    };
    const auto sum = sum_of<RootSum>(surfaces, pairs, workers, cancellation, add_pairs);
    return {sum.rounded_quotient(2, cancellation).value, true};
}

}  // namespace crumple
