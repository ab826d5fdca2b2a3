#include "checks/triangle_set.h"

#include <limits>
#include <numeric>
#include <utility>

namespace crumple::checks {
namespace {

/// Returns the distance of a point from a box.
double gap(const Vec3d& p, const CentredBox& box) {
    const Vec3d outside = max(abs(p - box.middle) - box.half, Vec3d{});
    return std::sqrt(dot(outside, outside));
}

}  // namespace

TriangleSet::TriangleSet(std::vector<TrianglePoints> triangles) : triangles_(std::move(triangles)) {
    const auto count = static_cast<std::int64_t>(triangles_.size());
    std::vector<std::int32_t> corners(3 * triangles_.size());
    std::iota(corners.begin(), corners.end(), 0);
    constexpr std::int64_t word = sizeof(double), index = sizeof(std::int32_t);
    tree_.build({VertexView{triangles_.data(), 3 * count, 3 * word, word, ScalarType::float64},
                 TriangleView{corners.data(), count, 3 * index, index, IndexType::int32}});
}

TriangleSet::Nearest TriangleSet::nearest(const Vec3d& p, std::int32_t start) const {
    Nearest best{std::numeric_limits<double>::infinity(), start};
    if (start >= 0) best.distance = distance(p, start);
    visit(0, p, best);
    return best;
}

void TriangleSet::visit(std::int32_t i, const Vec3d& p, Nearest& best) const {
    const ShapeTree::Node& node = tree_.node(i);
    if (node.group >= 0) {
        const ShapeTree::Group& group = tree_.group(node.group);
        for (std::int32_t k = 0; k < group.count; ++k) {
            const std::int32_t triangle = group.element[static_cast<std::size_t>(k)];
            if (const double at = distance(p, triangle); at < best.distance) best = {at, triangle};
        }
        return;
    }
    std::array<std::int32_t, 2> child{i + 1, node.right};
    std::array<double, 2> away;
    for (std::size_t k = 0; k < 2; ++k) away[k] = gap(p, tree_.box(tree_.node(child[k])));
    const std::size_t first = away[1] < away[0];
    for (const std::size_t k : {first, 1 - first})
        if (away[k] < best.distance) visit(child[k], p, best);
}

}  // namespace crumple::checks
