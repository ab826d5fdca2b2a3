#include "io/coloured/picture_windings.h"

#include <algorithm>
#include <cmath>

namespace crumple::io {
namespace {

constexpr Vec3d across = cross(Vec3d{1, 0, 0}, PictureWindings::direction);

Vec3d projected(const Vec3d& p) {
    return {dot(across, p), dot(cross(PictureWindings::direction, across), p), dot(PictureWindings::direction, p)};
}

bool is_before(const Vec3d& a, const Vec3d& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); }

/// True if a point lies to the left of the edge from a to b, in projection. A point is to the left of exactly one of
/// the edges a-b and b-a, even if it lies on the line. So a ray through an edge crosses exactly one of two triangles
/// that share the edge and lie on opposite sides of it.
bool is_left(const Vec3d& a, const Vec3d& b, const Vec3d& p) {
    if (is_before(b, a)) return !is_left(b, a, p);
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) > 0;
}

}  // namespace

PictureWindings::PictureWindings(std::span<const Vec3d> points, std::span<const std::int32_t> corners)
    : corners_(corners) {
    for (const Vec3d& p : points) points_.push_back(projected(p));
    if (points_.empty() || corners_.empty()) corners_ = {};
    if (corners_.empty()) return;
    low_ = high_ = points_[static_cast<std::size_t>(corners_[0])];
    for (const std::int32_t corner : corners_) {
        low_ = min(low_, points_[static_cast<std::size_t>(corner)]);
        high_ = max(high_, points_[static_cast<std::size_t>(corner)]);
    }
    const auto triangles = static_cast<std::int32_t>(corners_.size() / 3);
    size_ = std::clamp(static_cast<std::int32_t>(std::sqrt(triangles) / 2), 1, 256);
    first_.assign(static_cast<std::size_t>(size_) * static_cast<std::size_t>(size_) + 1, 0);
    for (std::int32_t t = 0; t < triangles; ++t) for_each_cell(t, [&](std::size_t cell) { ++first_[cell + 1]; });
    for (std::size_t cell = 1; cell < first_.size(); ++cell) first_[cell] += first_[cell - 1];
    triangles_.resize(first_.back());
    std::vector<std::size_t> next = first_;
    for (std::int32_t t = 0; t < triangles; ++t)
        for_each_cell(t, [&](std::size_t cell) { triangles_[next[cell]++] = t; });
}

std::int32_t PictureWindings::place(double x, double low, double high) const {
    const double share = (x - low) / (high - low);
    return share > 0 ? std::min(size_ - 1, static_cast<std::int32_t>(std::min(share, 1.0) * size_)) : 0;
}

/// Calls take(cell) for each cell that the triangle's box meets.
template <class Take>
void PictureWindings::for_each_cell(std::int32_t triangle, Take take) const {
    const std::int32_t* const c = &corners_[3 * static_cast<std::size_t>(triangle)];
    const Vec3d &a = points_[static_cast<std::size_t>(c[0])], &b = points_[static_cast<std::size_t>(c[1])],
                &d = points_[static_cast<std::size_t>(c[2])];
    const Vec3d low = min(min(a, b), d), high = max(max(a, b), d);
    for (std::int32_t y = row(low.y); y <= row(high.y); ++y)
        for (std::int32_t x = column(low.x); x <= column(high.x); ++x)
            take(static_cast<std::size_t>(y) * static_cast<std::size_t>(size_) + static_cast<std::size_t>(x));
}

int PictureWindings::at(const Vec3d& point, std::int32_t ignored) const {
    const Vec3d p = projected(point);
    if (corners_.empty() || !(p.x >= low_.x && p.x <= high_.x && p.y >= low_.y && p.y <= high_.y)) return 0;
    const std::size_t cell =
        static_cast<std::size_t>(row(p.y)) * static_cast<std::size_t>(size_) + static_cast<std::size_t>(column(p.x));
    int winding = 0;
    for (std::size_t i = first_[cell]; i < first_[cell + 1]; ++i) {
        if (triangles_[i] == ignored) continue;
        const std::int32_t* const c = &corners_[3 * static_cast<std::size_t>(triangles_[i])];
        const Vec3d &a = points_[static_cast<std::size_t>(c[0])], &b = points_[static_cast<std::size_t>(c[1])],
                    &d = points_[static_cast<std::size_t>(c[2])];
        const bool left = is_left(a, b, p);
        if (is_left(b, d, p) != left || is_left(d, a, p) != left) continue;
        const Vec3d normal = cross(b - a, d - a);
        // Only triangles above the point count. Seen from the far end of the ray, the ray leaves the body through
        // counter-clockwise triangles (+1) and enters it through clockwise ones (-1).
        if (dot(normal, p - a) * (left ? 1 : -1) < 0) winding += left ? 1 : -1;
    }
    return winding;
}

}  // namespace crumple::io
