#include "search/containment/winding_rays.h"

#include <algorithm>

#include "exact/overlap/exact_crossing.h"
#include "exact/overlap/filtered_crossing.h"

namespace crumple {
namespace {

/// Returns the contribution to the winding number at p of a face that is shifted infinitesimally
/// (exact/overlap/face_crossing.h): the sign with which the ray along +x from p crosses the face, or 0. Computed by
/// filters and expansions.
int filtered_winding_along_ray(const Vec3d& p, const FaceCorners& face, Shift shift) {
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

void add_crossing(const PlacedSurface& surface, const FaceCorners& face, Shift shift, WindingRay& ray) {
    if (misses_ray(ray.from, face)) return;
    const bool quick = surface.in_range && in_double_word_range(ray.from);
    ray.winding += quick ? filtered_winding_along_ray(ray.from, face, shift) : winding_along_ray(ray.from, face, shift);
}

}  // namespace

void add_crossing(const PlacedSurface& surface, std::int32_t face, Shift shift, WindingRay& ray) {
    add_crossing(surface, surface.corners(face), shift, ray);
}

void cast_rays(std::span<WindingRay> rays, const PlacedSurface& surface, Shift shift, Cancellation& cancellation) {
    if (rays.empty()) return;
    std::sort(rays.begin(), rays.end(), [](const WindingRay& x, const WindingRay& y) { return x.from.y < y.from.y; });
    for (std::int32_t f = 0; f < surface.surface->face_count(); ++f) {
        if (f % 4096 == 0) cancellation.check();
        const FaceCorners face = surface.corners(f);
        const double low = min(face[0].y, min(face[1].y, face[2].y)), high = max(face[0].y, max(face[1].y, face[2].y));
        const auto before = [](const WindingRay& ray, double y) { return ray.from.y < y; };
        for (auto ray = std::lower_bound(rays.begin(), rays.end(), low, before);
             ray != rays.end() && ray->from.y <= high; ++ray)
            add_crossing(surface, face, shift, *ray);
    }
}

}  // namespace crumple
