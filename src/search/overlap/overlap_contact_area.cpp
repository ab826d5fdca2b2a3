#include "search/overlap/overlap_contact_area.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <utility>

#include "exact/overlap/common_area.h"
#include "exact/overlap/fixed_sum.h"
#include "exact/overlap/rational_sum.h"
#include "search/overlap/overlap_coplanar_faces.h"

namespace crumple {
namespace {

// An area is that of its projection along an axis, times the length of the normal over the normal's component along
// that axis. Sums hold twice the area.

struct EnclosedArea {
    Enclosed twice{0};

    void add(const Enclosed& x) { twice = twice + x; }
    void add_quotient(const Enclosed& x, const Enclosed& y) { add(x / y); }
};

/// Adds up twice the areas of triangles whose coordinates are integers in units of 2^exponent.
struct ExactArea {
    RationalSum& twice;
    int exponent;

    void add(const Integer& x) { twice.add(x, 1, 2 * exponent); }
    void add_quotient(const Integer& x, const Integer& y) {
        y < 0 ? twice.add(-x, -y, 2 * exponent) : twice.add(x, y, 2 * exponent);
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

/// Adds the common areas of faces in the same planes.
void add_enclosed(const CoplanarFaces& faces, std::span<const Pair> pairs, FixedSum& sum) {
    for (std::size_t i = 0; i < pairs.size();) {
        const std::int32_t index = faces.face(0, pairs[i].a).plane;
        const CoplanarFaces::Plane& plane = faces.plane(index);
        EnclosedArea area;
        for (; i < pairs.size() && faces.face(0, pairs[i].a).plane == index; ++i) {
            const auto &a = faces.face(0, pairs[i].a).planar, &b = faces.face(1, pairs[i].b).planar;
            PlanarSigns signs(plane.projection, a, b);
            add_common_area(plane.projection, plane.apex, a, b, signs, area);
        }
        sum.add(area.twice * plane.stretch);
    }
}

void add_exactly(const FaceCorners& a, const FaceCorners& b, RootSum& sum) {
    const int exponent = common_exponent(std::array{a[0], a[1], a[2], b[0], b[1], b[2]});
    PlanarFace<Vec3<Integer>> p{in_units(a, exponent)}, q{in_units(b, exponent)};
    const Vec3<Integer> normal = cross(p.corner[1] - p.corner[0], p.corner[2] - p.corner[0]);
    const IntegerProjection projection{normal.x != 0 ? 0 : normal.y != 0 ? 1 : 2};
    for (auto* const face : {&p, &q})
        if (projection.sign(face->corner[0], face->corner[1], face->corner[2]) < 0)
            std::swap(face->corner[1], face->corner[2]);
    PlanarSigns signs(projection, p, q);
    if (signs.apart()) return;
    const auto wide = [](const Integer& x) { return Rational(mp::cpp_int(x)); };
    const Rational square = wide(dot(normal, normal)) / wide(normal[projection.axis] * normal[projection.axis]);
    ExactArea area{sum.times_root_of(square), exponent};
    add_common_area(projection, p.corner[0], p, q, signs, area);
}

/// Adds up the common areas of pairs of faces, in parallel chunks. add(pairs, sum) adds the areas of a chunk's pairs to
/// `sum`.
template <class Sum, class Add>
Sum sum_of(std::span<const Pair> pairs, ParallelFor& workers, Cancellation& cancellation, Add add) {
    constexpr std::size_t chunk = 256;
    Sum sum;
    std::mutex mutex;
    workers.parallel_for((pairs.size() + chunk - 1) / chunk, [&](std::size_t i) {
        cancellation.check();
        Sum part;
        add(pairs.subspan(i * chunk, std::min(chunk, pairs.size() - i * chunk)), part);
        const std::scoped_lock lock(mutex);
        sum.add(part);
    });
    return sum;
}

}  // namespace

ContactArea find_contact_area(const SurfacePair& surfaces, std::span<const Pair> pairs, ParallelFor& workers,
                              Cancellation& cancellation, MemoryMeter& meter) {
    if (pairs.empty()) return {};
    if (surfaces.in_range()) {
        const CoplanarFaces faces(surfaces, pairs, cancellation, meter);
        const auto add = [&](std::span<const Pair> some, FixedSum& sum) { add_enclosed(faces, some, sum); };
        if (faces.valid()) {
            const auto sum = sum_of<FixedSum>(faces.pairs(), workers, cancellation, add);
            if (const auto known = sum.rounded_quotient(2)) return {known->value};
        }
    }
    const auto add = [&](std::span<const Pair> some, RootSum& sum) {
        for (const Pair& pair : some) {
            cancellation.check();  // for each pair, because rational arithmetic is slow
            add_exactly(surfaces.corners(0, pair.a), surfaces.corners(1, pair.b), sum);
        }
    };
    const auto sum = sum_of<RootSum>(pairs, workers, cancellation, add);
    return {sum.rounded_quotient(2, cancellation).value, true};
}

}  // namespace crumple
