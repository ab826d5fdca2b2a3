#include "scenes/simulation/self_contact.h"

#include <algorithm>

#include "scenes/arithmetic.h"

namespace crumple::scenes {
namespace {

/// Returns the barycentric weights of p's projection to the plane of a, b and c, whose normal (not normalised) is
/// given.
std::array<double, 3> weights_of(Vec3d p, Vec3d a, Vec3d b, Vec3d c, Vec3d normal) {
    const double whole = dot(normal, normal);
    const double u = std::clamp(dot(cross(c - b, p - b), normal) / whole, 0.0, 1.0);
    const double v = std::clamp(dot(cross(a - c, p - c), normal) / whole, 0.0, 1.0 - u);
    return {u, v, 1 - u - v};
}

}  // namespace

std::span<const SelfContact> SelfContactFinder::find(std::span<const Vec3d> points,
                                                     std::span<const Fabric::Corners> triangles, double reach) {
    const std::size_t n = points.size(), m = triangles.size();
    const auto at = [&](std::int32_t i) { return points[static_cast<std::size_t>(i)]; };
    const auto normal_of = [&](const Fabric::Corners& t) { return cross(at(t[1]) - at(t[0]), at(t[2]) - at(t[0])); };

    normals_.assign(n, {});
    for (const Fabric::Corners& t : triangles) {
        const Vec3d normal = normal_of(t);
        for (const std::int32_t corner : t) {
            Vec3d& sum = normals_[static_cast<std::size_t>(corner)];
            sum = sum + normal;
        }
    }
    vertices_.clear();
    const auto add_vertex = [&](Vec3d p) {
        for (int k = 0; k < 3; ++k) vertices_.push_back(static_cast<float>(p[k]));
    };
    for (const Vec3d p : points) add_vertex(p);
    soup_.assign(triangles.begin(), triangles.end());
    for (std::size_t i = 0; i < n; ++i) {
        const Vec3d whisker = reach * normalised(normals_[i]);
        const auto end = static_cast<std::int32_t>(n + 2 * i);
        add_vertex(points[i] - whisker);
        add_vertex(points[i] + whisker);
        soup_.push_back({static_cast<std::int32_t>(i), end, end + 1});
    }
    groups_.assign(m + n, 0);
    std::fill(groups_.begin() + static_cast<std::ptrdiff_t>(m), groups_.end(), 1);

    const MeshView soup(vertices_.data(), static_cast<std::int64_t>(3 * n), soup_.data()->data(),
                        static_cast<std::int64_t>(m + n), groups_);
    IntersectionQuery query;
    query.neighbours = Neighbours::skip;  // leaves out a point's own triangles
    query.filter.groups = PairScope::between;
    contacts_.clear();
    for (const Pair pair : detector_.find(soup, query).pairs) {
        const Fabric::Corners& t = triangles[static_cast<std::size_t>(pair.a)];
        const auto point = pair.b - static_cast<std::int32_t>(m);
        const Vec3d normal = normal_of(t), p = at(point);
        const double area = length(normal);
        if (!(area > 0)) continue;  // degenerate, without sides
        const double distance = dot(normal, p - at(t[0])) / area;
        contacts_.push_back({point, t, weights_of(p, at(t[0]), at(t[1]), at(t[2]), normal), distance < 0 ? -1.0 : 1.0,
                             std::abs(distance)});
    }
    return contacts_;
}

}  // namespace crumple::scenes
