#include "search/withdrawal/projected_tree.h"

#include <algorithm>
#include <limits>

namespace crumple {
namespace {

constexpr std::size_t projected_per_task = 4096;   ///< triangles that a task projects
constexpr std::int32_t largest_small_node = 1024;  ///< triangles of a node that has a tight rectangle

int largest_axis(const Vec3d& d) {
    const Vec3d size = abs(d);
    return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

double middle(const Bounds& box, int axis) { return 0.5 * box.low[axis] + 0.5 * box.high[axis]; }

/// Returns half the length along an axis of a rectangle's projection to the axis.
double half_extent(const PlaceRectangle& r, const Place& axis) {
    return r.half_length * std::abs(dot(axis, r.along)) + r.half_width * std::abs(dot(axis, r.across()));
}

PlaceRectangle rectangle_of(const Bounds& box) {
    return {{middle(box, 0), middle(box, 1)},
            {1, 0},
            0.5 * box.high.x - 0.5 * box.low.x,
            0.5 * box.high.y - 0.5 * box.low.y};
}

/// Least and greatest coordinate along an axis.
struct AxisInterval {
    double low = std::numeric_limits<double>::infinity(), high = -low;

    void widen(double x) { low = std::min(low, x), high = std::max(high, x); }
};

AxisInterval interval_along(const PlaceTriangle& p, const Place& axis) {
    AxisInterval interval;
    for (const Place& corner : p) interval.widen(dot(axis, corner));
    return interval;
}

bool normal_separates(const PlaceTriangle& of, const PlaceTriangle& other, double margin) {
    for (std::size_t k = 0; k < 3; ++k) {
        const Place edge = of[k == 2 ? 0 : k + 1] - of[k], normal{-edge.v, edge.u};
        const AxisInterval own = interval_along(of, normal), others = interval_along(other, normal);
        const double most_error = margin * (std::abs(normal.u) + std::abs(normal.v)) + 0x1p-1060;
        if (own.low - others.high > most_error || others.low - own.high > most_error) return true;
    }
    return false;
}

}  // namespace

bool are_apart(const PlaceRectangle& a, const PlaceRectangle& b, double margin) {
    for (const Place& axis : {a.across(), b.across(), a.along, b.along}) {
        const double distance = std::abs(dot(axis, b.middle - a.middle));
        if (distance > half_extent(a, axis) + half_extent(b, axis) + margin) return true;
    }
    return false;
}

bool are_apart(const PlaceTriangle& a, const PlaceTriangle& b, double margin) {
    return normal_separates(a, b, margin) || normal_separates(b, a, margin);
}

// The place x − slope · height, with numbers of a magnitude of at most `largest`, has a rounding error of at most
// 4.01 · 2^-53 · largest: 2 · 2^-53 for the slope and the product, and for the difference 2^-53 of up to 2 · largest.
// Subnormal numbers may add 3 · 2^-1074. Without a slope there is no error.
ProjectionAlong::ProjectionAlong(const Vec3d& direction, double largest)
    : axis_(largest_axis(direction)),
      across_{(axis_ + 1) % 3, (axis_ + 2) % 3},
      sign_(direction[axis_] > 0 ? 1 : -1),
      scale_(largest > 0x1p1000 ? 0x1p-8 : 1) {
    for (std::size_t k = 0; k < 2; ++k) {
        // The quotient of two numbers as small as subnormal ones is as precise as that of others.
        slope_[k] = direction[across_[k]] / direction[axis_] * sign_;
        error_[k] = direction[across_[k]] == 0 ? 0 : 0x1p-50 * (scale_ * largest) + 0x1p-1070;
    }
    margin_ = 0x1p-44 * (scale_ * largest) + 0x1p-1060;
}

Place ProjectionAlong::place(const Vec3d& p) const {
    const double height = scale_ * (sign_ * p[axis_]);
    return {scale_ * p[across_[0]] - slope_[0] * height, scale_ * p[across_[1]] - slope_[1] * height};
}

Bounds ProjectionAlong::operator()(const std::array<Vec3d, 3>& corners) const {
    Bounds box = no_bounds;
    for (const Vec3d& p : corners) {
        const Place at = place(p);
        box.widen(Vec3d{at.u, at.v, sign_ * p[axis_]});
    }
    for (std::size_t k = 0; k < 2; ++k) {
        box.low[static_cast<int>(k)] -= error_[k];
        box.high[static_cast<int>(k)] += error_[k];
    }
    return box;
}

ProjectedTree::ProjectedTree(const PlacedSurface& surface, const ProjectionAlong& projection, ParallelFor& workers,
                             Cancellation& cancellation)
    : surface_(surface), projection_(projection), triangles_(static_cast<std::size_t>(surface.surface->face_count())) {
    const std::size_t n = triangles_.size();
    workers.parallel_for((n + projected_per_task - 1) / projected_per_task, [&](std::size_t block) {
        cancellation.check();
        for (std::size_t i = block * projected_per_task; i < std::min(n, (block + 1) * projected_per_task); ++i) {
            const auto face = static_cast<std::int32_t>(i);
            triangles_[i] = {projection(surface.corners(face)), face};
        }
    });
    nodes_.push_back(make_node(0, static_cast<std::int32_t>(n)));
}

ProjectedTree::Node ProjectedTree::make_node(std::int32_t begin, std::int32_t end) const {
    Node node{no_bounds, begin, end, 0, {}};
    for (std::int32_t i = begin; i < end; ++i) node.box.widen(triangle(i).box);
    node.rectangle = node.size() <= largest_small_node ? make_rectangle(node) : rectangle_of(node.box);
    return node;
}

PlaceTriangle ProjectedTree::places(const ProjectedTriangle& triangle) const {
    const std::array<Vec3d, 3> p = surface_.corners(triangle.face);
    return {projection_.place(p[0]), projection_.place(p[1]), projection_.place(p[2])};
}

// The rectangle is parallel to the principal axes of the corners. Rounding of the axes does no harm.
PlaceRectangle ProjectedTree::make_rectangle(const Node& node) const {
    const Place origin{middle(node.box, 0), middle(node.box, 1)};
    double u = 0, v = 0, uu = 0, uv = 0, vv = 0;
    const auto for_each_corner = [&](auto&& visit) {
        for (std::int32_t i = node.begin; i < node.end; ++i)
            for (const Place& p : places(triangle(i))) visit(p - origin);
    };
    for_each_corner([&](const Place& p) {
        u += p.u, v += p.v;
        uu += p.u * p.u, uv += p.u * p.v, vv += p.v * p.v;
    });
    const double n = 3.0 * node.size();
    const double angle = 0.5 * std::atan2(2 * (uv - u * v / n), (uu - u * u / n) - (vv - v * v / n));
    PlaceRectangle r;
    r.along = {std::cos(angle), std::sin(angle)};
    if (!std::isfinite(r.along.u)) return rectangle_of(node.box);
    AxisInterval length, width;
    for_each_corner([&](const Place& p) {
        length.widen(dot(r.along, p));
        width.widen(dot(r.across(), p));
    });
    const double s = 0.5 * length.low + 0.5 * length.high, t = 0.5 * width.low + 0.5 * width.high;
    r.middle = {origin.u + s * r.along.u + t * r.across().u, origin.v + s * r.along.v + t * r.across().v};
    r.half_length = 0.5 * length.high - 0.5 * length.low;
    r.half_width = 0.5 * width.high - 0.5 * width.low;
    return r;
}

std::int32_t ProjectedTree::first_child(std::int32_t index) {
    const Node node = nodes_[static_cast<std::size_t>(index)];
    if (node.child != 0) return node.child;
    const std::int32_t middle = split(node), child = static_cast<std::int32_t>(nodes_.size());
    nodes_.push_back(make_node(node.begin, middle));
    nodes_.push_back(make_node(middle, node.end));
    nodes_[static_cast<std::size_t>(index)].child = child;
    return child;
}

// Divides the triangles of a node at the middle of its longest side or, if that puts almost all of them on one side, at
// their median. Returns the first triangle of the second part.
std::int32_t ProjectedTree::split(const Node& node) {
    Vec3d extent = 0.5 * node.box.high - 0.5 * node.box.low;
    extent.z *= 0.25;  // mostly splits places, because these separate walls that are parallel to the direction
    const int axis = largest_axis(extent);
    const auto begin = triangles_.begin() + node.begin, end = triangles_.begin() + node.end;
    const double at = middle(node.box, axis);
    const auto below = [&](const ProjectedTriangle& t) { return middle(t.box, axis) < at; };
    const auto part = static_cast<std::int32_t>(std::partition(begin, end, below) - triangles_.begin());
    const std::int32_t least = node.size() / 16 + 1;
    if (part - node.begin >= least && node.end - part >= least) return part;
    const auto median = begin + node.size() / 2;
    std::nth_element(begin, median, end, [&](const ProjectedTriangle& x, const ProjectedTriangle& y) {
        return middle(x.box, axis) < middle(y.box, axis);
    });
    return node.begin + node.size() / 2;
}

}  // namespace crumple
