#include "scene/shape_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "crumple/error.h"
#include "scene/joined_lists.h"

namespace crumple {
namespace {

/// Number and bounding box of some centroids of elements.
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

void ShapeTree::build(const Shape& shape, TreeElements elements) {
    const bool all = elements == TreeElements::all;
    const CodimensionalFeatures lists = all ? checked_lists(shape, "") : CodimensionalFeatures();
    const std::int64_t triangles = shape.triangles.rows;
    const auto edges = lists.edges ? static_cast<std::int64_t>(lists.edges->size()) : 0;
    const std::int64_t n = triangles + edges + (lists.points ? static_cast<std::int64_t>(lists.points->size()) : 0);
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
    const std::int64_t leaves = (n + most_elements - 1) / most_elements;
    node_.reserve(static_cast<std::size_t>(2 * leaves));
    first_.reserve(static_cast<std::size_t>(2 * leaves));
    group_.reserve(static_cast<std::size_t>(leaves));
    with_corner_reader(shape, [&](auto corner) {
        const auto corners = [&](std::int64_t i) -> std::array<std::int64_t, 3> {
            if (i < triangles) return {corner(i, 0), corner(i, 1), corner(i, 2)};
            if (i < triangles + edges) {
                const Edge& edge = (*lists.edges)[static_cast<std::size_t>(i - triangles)];
                return {edge.a, edge.b, edge.b};
            }
            const std::int32_t v = (*lists.points)[static_cast<std::size_t>(i - triangles - edges)];
            return {v, v, v};
        };
        Item* item = order_.resize_discard(static_cast<std::size_t>(n));
        for (std::int64_t i = 0; i < n; ++i) {
            Vec3d sum;
            for (const std::int64_t v : corners(i)) {
                if (v < 0 || v >= shape.vertices.rows) fail_index("", i, v, shape.vertices.rows);
                sum = sum + (1.0 / 3) * position(v);
            }
            item[i] = {sum, static_cast<std::int32_t>(i)};
        }
        add_node(shape, item, item + n, corners);
    });
    frame_ = SmallFrame(box_[0]);
    for (std::size_t i = 0; i < node_.size(); ++i) node_[i].box = frame_(box_[i]);
    box_.release();
    order_.release();
}

// Splits along the longest axis, where the sum over both sides of box surface times number of elements is least
// (surface area heuristic: the probability that a walk enters a box is about proportional to its surface). The boxes
// are those of the centroids. Of the 31 candidate places, those that leave less than an eighth of the elements on one
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
        return a.centroid[axis] != b.centroid[axis] ? a.centroid[axis] < b.centroid[axis] : a.element < b.element;
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
    if (end - begin <= most_elements) {
        node_[i].group = static_cast<std::int32_t>(group_.size());
        const Bounds box = add_group(shape, begin, end, corners);
        first_[i] = group_.back().element[0];
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
    std::sort(begin, end, [](const Item& a, const Item& b) { return a.element < b.element; });
    const VertexReader position = reader_of(shape);
    std::array<std::int64_t, 3 * most_elements> vertex;
    Group group;
    group.first_block = static_cast<std::int64_t>(vertex_.size()) / 12;
    for (const Item* item = begin; item != end; ++item) {
        const auto k = static_cast<std::size_t>(group.count++);
        group.element[k] = item->element;
        const auto ids = corners(item->element);
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
