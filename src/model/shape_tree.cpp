#include "model/shape_tree.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace crumple {

void ShapeTree::build(const Shape& shape) {
    const std::int64_t n = shape.triangles.rows;
    const VertexReader position = reader_of(shape);
    node_.clear();
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

template <class Corners>
Bounds ShapeTree::add_node(const Shape& shape, Item* begin, Item* end, Corners corners) {
    const auto i = static_cast<std::int32_t>(node_.size());
    node_.push_back({});
    box_.push_back({});
    const auto box_of = [&](const Bounds& box) {
        box_[i] = CentredBox(box);
        return box;
    };
    if (end - begin <= most_triangles) {
        node_[i].group = static_cast<std::int32_t>(group_.size());
        return box_of(add_group(shape, begin, end, corners));
    }
    Bounds centroids = no_bounds;
    for (const Item* item = begin; item != end; ++item) centroids.widen(item->centroid);
    const Vec3d size = 0.5 * centroids.high - 0.5 * centroids.low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::int64_t leaves = (end - begin + most_triangles - 1) / most_triangles;
    Item* const middle = begin + (leaves + 1) / 2 * most_triangles;
    std::nth_element(begin, middle, end, [axis](const Item& a, const Item& b) {
        return a.centroid[axis] != b.centroid[axis] ? a.centroid[axis] < b.centroid[axis] : a.triangle < b.triangle;
    });
    Bounds box = add_node(shape, begin, middle, corners);
    node_[i].right = static_cast<std::int32_t>(node_.size());
    box.widen(add_node(shape, middle, end, corners));
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
