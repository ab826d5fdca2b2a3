#include "search/overlap_windings.h"

#include <algorithm>

#include "exact/overlap/quick_crossing.h"
#include "exact/overlap/rational_crossing.h"

namespace crumple {
namespace {

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

}  // namespace

void WindingSteps::add_jumps(const ClosedSurface& surface, std::int32_t face, const EdgeJumps& jumps) {
    for (std::size_t edge = 0; edge < 3; ++edge) {
        const int direction = jumps[edge] == 0 ? 0 : surface.forest_edge(face, edge);
        if (direction == 0) continue;
        const std::int32_t* c = surface.corners(face);
        const std::int32_t place = surface.place(c[direction > 0 ? next_corner(edge) : edge]);
        add(place, surface.end_of(place), direction * jumps[edge]);
    }
}

void WindingSteps::add_components(const PlacedSurface& of, const PlacedSurface& other, Shift shift,
                                  Cancellation& cancellation) {
    const auto& first = of.surface->components();
    const bool quick = of.in_range && other.in_range;
    for (std::size_t c = 0; c + 1 < first.size(); ++c) {
        const Vec3d p = of.points[of.surface->vertex_at(first[c])];
        if (!overlap(Bounds{p, p}, other.box)) continue;
        cancellation.check();
        std::int32_t winding = 0;
        for (const std::int32_t f : other.surface->faces(0, other.surface->places())) {
            const FaceCorners face = other.corners(f);
            if (misses_ray(p, face)) continue;
            winding += quick ? quick_winding_along_ray(p, face, shift) : winding_along_ray(p, face, shift);
        }
        add(first[c], first[c + 1], winding);
    }
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

std::int32_t WindingSteps::winding_at(std::int32_t place) const {
    const auto before = [](std::int32_t p, const WindingInterval& interval) { return p < interval.begin; };
    const auto after = std::upper_bound(intervals_.begin(), intervals_.end(), place, before);
    if (after == intervals_.begin()) return 0;
    const WindingInterval& interval = *std::prev(after);
    return place < interval.end ? interval.winding : 0;
}

}  // namespace crumple
