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

/// A ray along +x from the first vertex of a component.
struct Ray {
    Vec3d from;
    std::size_t component;
    std::int32_t winding;
};

bool misses_ray(const Vec3d& p, const FaceCorners& face) {
    if (max(face[0].x, max(face[1].x, face[2].x)) < p.x) return true;
    for (int axis = 1; axis < 3; ++axis) {
        if (min(face[0][axis], min(face[1][axis], face[2][axis])) > p[axis]) return true;
        if (max(face[0][axis], max(face[1][axis], face[2][axis])) < p[axis]) return true;
    }
    return false;
}

/// Adds the winding numbers of a surface, which is shifted, where rays start.
void cast(std::vector<Ray>& rays, const PlacedSurface& surface, bool quick, Shift shift, Cancellation& cancellation) {
    if (rays.empty()) return;
    std::sort(rays.begin(), rays.end(), [](const Ray& x, const Ray& y) { return x.from.y < y.from.y; });
    for (std::int32_t f = 0; f < surface.surface->face_count(); ++f) {
        if (f % 4096 == 0) cancellation.check();
        const FaceCorners face = surface.corners(f);
        const double low = min(face[0].y, min(face[1].y, face[2].y)), high = max(face[0].y, max(face[1].y, face[2].y));
        const auto before = [](const Ray& ray, double y) { return ray.from.y < y; };
        for (auto ray = std::lower_bound(rays.begin(), rays.end(), low, before);
             ray != rays.end() && ray->from.y <= high; ++ray) {
            if (misses_ray(ray->from, face)) continue;
            ray->winding +=
                quick ? quick_winding_along_ray(ray->from, face, shift) : winding_along_ray(ray->from, face, shift);
        }
    }
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

// Where a component has a vertex outside of the other's box, the winding number there is 0, and at its first vertex
// what the steps between them say. Rays of all other components are taken through the faces at once.
void WindingSteps::add_components(const PlacedSurface& of, const PlacedSurface& other, Shift shift,
                                  Cancellation& cancellation) {
    std::sort(steps_.begin(), steps_.end());
    const auto& first = of.surface->components();
    const auto is_outside = [&](std::int32_t place) {
        const Vec3d& p = of.points[of.surface->vertex_at(place)];
        return !overlap(Bounds{p, p}, other.box);
    };
    std::vector<Ray> rays;
    std::vector<WindingInterval> found;
    std::size_t step = 0;
    std::int32_t winding = 0;  // by the steps before that one: those of components before have ended
    for (std::size_t c = 0; c + 1 < first.size(); ++c) {
        std::int32_t place = first[c];
        while (place < first[c + 1] && !is_outside(place)) ++place;
        if (place == first[c + 1]) {
            rays.push_back({of.points[of.surface->vertex_at(first[c])], c, 0});
            continue;
        }
        for (; step < steps_.size() && steps_[step].place <= place; ++step) winding += steps_[step].change;
        found.push_back({first[c], first[c + 1], -winding});
    }
    cast(rays, other, of.in_range && other.in_range, shift, cancellation);
    for (const Ray& ray : rays) found.push_back({first[ray.component], first[ray.component + 1], ray.winding});
    for (const WindingInterval& whole : found) add(whole.begin, whole.end, whole.winding);
}

void WindingSteps::make_intervals() {
    std::sort(steps_.begin(), steps_.end());
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
