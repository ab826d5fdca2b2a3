#include "scene/shape_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace crumple {
namespace {

/// Number and bounding box of some centroids of triangles.
struct Section {
    Bounds box = no_bounds;
    std::int64_t count = 0;

    void add(const Section& other) {
        box.widen(other.box);
        count += other.count;
    }
    double cost() const {
        const Vec3d size = box.high - box.low;
        return static_cast<double>(count) * (size.x * size.y + size.y * size.z + size.z * size.x);
    }
};

}  // namespace

void ShapeTree::build(const Shape& shape) {
    const std::int64_t n = shape.triangles.rows;
    const VertexReader position = reader_of(shape);
    node_.clear();
    first_.clear();
    group_.clear();
    vertex_.clear();
    box_.clear();
    for (std::int64_t v = 0; v < shape.vertices.rows; ++v) {
        const Vec3d p = position(v);
        if (!(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z))) fail_not_finite("", v);
    }
    if (n == 0) return;
    const std::int64_t leaves = (n + most_triangles - 1) / most_triangles;
    node_.reserve(static_cast<std::size_t>(2 * leaves));
    first_.reserve(static_cast<std::size_t>(2 * leaves));
    group_.reserve(static_cast<std::size_t>(leaves));
    with_corner_reader(shape, [&](auto corner) {
        const auto corners = [&](std::int64_t t) {
            std::array<std::int64_t, 3> c;
            for (int k = 0; k < 3; ++k) c[static_cast<std::size_t>(k)] = corner(t, k);
            return c;
        };
        Item* item = order_.resize_discard(static_cast<std::size_t>(n));
        for (std::int64_t t = 0; t < n; ++t) {
            Vec3d sum;
            for (const std::int64_t v : corners(t)) {
                if (v < 0 || v >= shape.vertices.rows) fail_index("", t, v, shape.vertices.rows);
                sum = sum + (1.0 / 3) * position(v);
            }
            item[t] = {sum, static_cast<std::int32_t>(t)};
        }
        add_node(shape, item, item + n, corners);
    });
    frame_ = SmallFrame(box_[0]);
    for (std::size_t i = 0; i < node_.size(); ++i) node_[i].box = frame_(box_[i]);
    box_.release();
    order_.release();
}

// Splits along the longest axis, where the sum over both sides of box surface times number of triangles is least
// (surface area heuristic: the probability that a walk enters a box is about proportional to its surface). The boxes
// are those of the centroids. Of the 31 candidate places, those that leave less than an eighth of the triangles on one
// side are skipped, so that the depth of the tree is logarithmic. If none is left, splits at the median centroid.
ShapeTree::Item* ShapeTree::split(Item* begin, Item* end) {
    constexpr int bins = 32, least_share = 8;
    Section all;
    for (const Item* item = begin; item != end; ++item) all.add({{item->centroid, item->centroid}, 1});
    const Vec3d half = 0.5 * all.box.high - 0.5 * all.box.low;
    const int axis = half.x >= half.y && half.x >= half.z ? 0 : half.y >= half.z ? 1 : 2;
    const double low = all.box.low[axis], scale = bins / (2 * half[axis]);
    const auto bin_of = [&](const Item& item) {
        const double at = (item.centroid[axis] - low) * scale;  // NaN if the extent leaves float64's range
        return at > 0 ? static_cast<std::size_t>(min(at, bins - 1.0)) : 0;
    };
    std::array<Section, bins> bin, right;
    for (const Item* item = begin; item != end; ++item) bin[bin_of(*item)].add({{item->centroid, item->centroid}, 1});
    right[bins - 1] = bin[bins - 1];
    for (std::size_t k = bins - 1; k > 0; --k) (right[k - 1] = right[k]).add(bin[k - 1]);
    Section left;
    std::size_t cut = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 1; k < bins; ++k) {
        left.add(bin[k - 1]);
        if (least_share * min(left.count, right[k].count) < all.count) continue;
        if (const double cost = left.cost() + right[k].cost(); cost < least) least = cost, cut = k;
    }
    if (cut > 0) return std::partition(begin, end, [&](const Item& item) { return bin_of(item) < cut; });
    Item* const middle = begin + (end - begin) / 2;
    std::nth_element(begin, middle, end, [axis](const Item& a, const Item& b) {
        return a.centroid[axis] != b.centroid[axis] ? a.centroid[axis] < b.centroid[axis] : a.triangle < b.triangle;
    });
    return middle;
}

template <class Corners>
Bounds ShapeTree::add_node(const Shape& shape, Item* begin, Item* end, Corners corners) {
    const auto i = static_cast<std::int32_t>(node_.size());
    node_.push_back({});
    box_.push_back({});
    first_.push_back(0);
    const auto box_of = [&](const Bounds& box) {
        box_[i] = CentredBox(box);
        return box;
    };
    if (end - begin <= most_triangles) {
        node_[i].group = static_cast<std::int32_t>(group_.size());
        const Bounds box = add_group(shape, begin, end, corners);
        first_[i] = group_.back().triangle[0];
        return box_of(box);
    }
    Item* const middle = split(begin, end);
    Bounds box = add_node(shape, begin, middle, corners);
    node_[i].right = static_cast<std::int32_t>(node_.size());
    box.widen(add_node(shape, middle, end, corners));
    first_[i] = std::min(first_[i + 1], first_[node_[i].right]);
    return box_of(box);
}

template <class Corners>
Bounds ShapeTree::add_group(const Shape& shape, Item* begin, Item* end, Corners corners) {
    std::sort(begin, end, [](const Item& a, const Item& b) { return a.triangle < b.triangle; });
    const VertexReader position = reader_of(shape);
    std::array<std::int64_t, 3 * most_triangles> vertex;
    Group group;
    group.first_block = static_cast<std::int64_t>(vertex_.size()) / 12;
    for (const Item* item = begin; item != end; ++item) {
        const auto k = static_cast<std::size_t>(group.count++);
        group.triangle[k] = item->triangle;
        const auto ids = corners(item->triangle);
        for (std::size_t c = 0; c < 3; ++c) {
            const auto known = std::find(vertex.begin(), vertex.begin() + group.vertices, ids[c]);
            if (known == vertex.begin() + group.vertices) {
                *known = ids[c];
                ++group.vertices;
            }
            group.corner[k][c] = static_cast<std::uint8_t>(known - vertex.begin());
        }
    }
    Bounds box = no_bounds;
    for (std::int32_t v = 0; v < group.vertices; ++v) box.widen(position(vertex[static_cast<std::size_t>(v)]));
    group.blocks = (group.vertices + 3) / 4;
    for (int axis = 0; axis < 3; ++axis)
        for (std::int32_t v = 0; v < 4 * group.blocks; ++v)
            vertex_.push_back(position(vertex[static_cast<std::size_t>(std::min(v, group.vertices - 1))])[axis]);
    group_.push_back(group);
    return box;
}

}  // namespace crumple
