#include "search/overlap_row.h"

#include <algorithm>

#include "exact/overlap/rational_crossing.h"

namespace crumple {
namespace {

PlacedFace<Enclosed> placed(const FaceCorners& p, const Vec3<Enclosed>& normal, const Vec3d& origin) {
    return {{enclosed_difference(p[0], origin), enclosed_difference(p[1], origin), enclosed_difference(p[2], origin)},
            normal};
}

void add(const VolumeTerms<Enclosed>& terms, OverlapSums& sums) {
    sums.volume.add(terms.volume);
    for (int axis = 0; axis < 3; ++axis) sums.moment[static_cast<std::size_t>(axis)].add(terms.moment[axis]);
}

void add(const CurveTerms<Enclosed>& terms, int times, OverlapSums& sums) {
    for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        for (int i = 0; i < times; ++i) sums.area[k].add(terms.area[axis]), sums.torque[k].add(terms.torque[axis]);
    }
}

/// What a face adds to the winding number of its surface, which is shifted, at p.
int winding_along_ray(const Vec3d& p, const FaceCorners& face, Shift shift) {
    if (max(face[0].x, max(face[1].x, face[2].x)) < p.x) return 0;
    for (int axis = 1; axis < 3; ++axis) {
        if (min(face[0][axis], min(face[1][axis], face[2][axis])) > p[axis]) return 0;
        if (max(face[0][axis], max(face[1][axis], face[2][axis])) < p[axis]) return 0;
    }
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

}  // namespace

void WindingSteps::add_jump(const ClosedSurface& surface, std::int32_t face, std::size_t edge, int jump) {
    const int direction = surface.forest_edge(face, edge);
    if (direction == 0 || jump == 0) return;
    const std::int32_t* c = surface.corners(face);
    const std::int32_t place = surface.place(c[direction > 0 ? next_corner(edge) : edge]);
    add(place, surface.end_of(place), direction * jump);
}

const std::vector<WindingInterval>& WindingSteps::intervals() {
    std::sort(steps_.begin(), steps_.end());
    intervals_.clear();
    std::int32_t winding = 0;
    for (std::size_t i = 0; i < steps_.size();) {
        const std::int32_t place = steps_[i].place;
        if (winding != 0) intervals_.back().end = place;
        for (; i < steps_.size() && steps_[i].place == place; ++i) winding += steps_[i].change;
        if (winding != 0) intervals_.push_back({place, place, winding});
    }
    return intervals_;
}

void OverlapOfBodies::find(const PlacedSurface& a, const PlacedSurface& b, std::span<const Pair> pairs,
                           const Vec3d& origin, OverlapSums& sums) {
    origin_ = origin;
    of_a_.clear();
    of_b_.clear();
    sums = {};
    sums.surfaces_meet = !pairs.empty();
    add_pairs(a, b, pairs, sums);
    add_components(a, b, Shift::forward, of_a_);
    add_components(b, a, Shift::backward, of_b_);
    add_inside(a, of_a_, sums);
    add_inside(b, of_b_, sums);
}

void OverlapOfBodies::add_pairs(const PlacedSurface& a, const PlacedSurface& b, std::span<const Pair> pairs,
                                OverlapSums& sums) {
    for (std::size_t i = 0; i < pairs.size();) {
        const std::int32_t face_a = pairs[i].a;
        const CrossedFace crossed_a(a.corners(face_a));
        const PlacedFace<Enclosed> placed_a = placed(crossed_a.corner, crossed_a.normal(), origin_);
        for (; i < pairs.size() && pairs[i].a == face_a; ++i) {
            const std::int32_t face_b = pairs[i].b;
            const CrossedFace crossed_b(b.corners(face_b));
            const QuickCrossing crossing = cross_quickly(crossed_a, crossed_b, Shift::forward);
            for (std::size_t k = 0; k < 3; ++k) {
                of_a_.add_jump(*a.surface, face_a, k, crossing.jumps.a[k]);
                of_b_.add_jump(*b.surface, face_b, k, crossing.jumps.b[k]);
            }
            const auto add_curve = [&](const QuickCrossing& of, int times) {
                CurveTerms<Enclosed> terms;
                terms.add(placed_a.at(of.start_in_a), placed_a.at(of.end_in_a));
                add(terms, times, sums);
            };
            if (crossing.jumps.segment) {
                VolumeTerms<Enclosed> terms;
                terms.add(placed_a, crossing.a);
                terms.add(placed(crossed_b.corner, crossed_b.normal(), origin_), crossing.b);
                add(terms, sums);
                add_curve(crossing, crossing.tied ? 1 : 2);
            }
            if (crossing.tied) {
                const QuickCrossing other = cross_quickly(crossed_a, crossed_b, Shift::backward);
                if (other.jumps.segment) add_curve(other, 1);
            }
        }
    }
}

void OverlapOfBodies::add_components(const PlacedSurface& of, const PlacedSurface& other, Shift shift,
                                     WindingSteps& steps) {
    const auto& first = of.surface->components();
    for (std::size_t c = 0; c + 1 < first.size(); ++c) {
        const Vec3d p = of.points[of.surface->vertex_at(first[c])];
        if (!overlap(Bounds{p, p}, other.box)) continue;
        std::int32_t winding = 0;
        for (const std::int32_t face : other.surface->faces(0, other.surface->places()))
            winding += winding_along_ray(p, other.corners(face), shift);
        steps.add(first[c], first[c + 1], winding);
    }
}

void OverlapOfBodies::add_inside(const PlacedSurface& of, WindingSteps& steps, OverlapSums& sums) {
    for (const WindingInterval& interval : steps.intervals()) {
        sums.windings = true;
        for (const std::int32_t face : of.surface->faces(interval.begin, interval.end)) {
            VolumeTerms<Enclosed> terms;
            const FaceCorners p = of.corners(face);
            terms.add(placed(p, CrossedFace(p).normal(), origin_), interval.winding);
            add(terms, sums);
        }
    }
}

}  // namespace crumple
