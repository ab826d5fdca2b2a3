#include "search/walks/point_walk.h"

#include <algorithm>
#include <limits>

#include "exact/distance/filtered_nearest.h"
#include "search/containment/winding_rays.h"

namespace crumple {
namespace {

/// Exceeds by far what underflow in scaled coordinates changes.
constexpr double underflow_slack = 0x1p-500;

double tree_scale(const PlacedSurface& surface) {
    if (surface.in_range) return 1;
    double most = 0;
    const Bounds box = box_of_faces(surface);
    for (int axis = 0; axis < 3; ++axis) most = max(most, max(std::abs(box.low[axis]), std::abs(box.high[axis])));
    return most == 0 ? 1 : std::ldexp(1.0, std::clamp(-std::ilogb(most), -1022, 1022));
}

Shape shape_of_surface(const PlacedSurface& surface) {
    const std::int64_t triangles = surface.surface->face_count();
    const std::int32_t* corners = surface.surface->corners(0);
    const std::int64_t vertices = surface.vertex_count;
    constexpr std::int64_t word = sizeof(double), index = sizeof(std::int32_t);
    return {VertexView{surface.points, vertices, 3 * word, word, ScalarType::float64},
            TriangleView{corners, triangles, 3 * index, index, IndexType::int32}};
}

}  // namespace

// The upper bound is derived in docs/nearest.md.
GuessedPoint::GuessedPoint(const Vec3d& p, const TrianglePoints& triangle) : differences(vertex_and_face(p, triangle)) {
    const detail::Guess guess = detail::guess_closest(differences);
    away = differences.w + guess.s * differences.u + guess.t * differences.v;
    upper = ((1 + 16 * detail::near_epsilon) * std::sqrt(dot(away, away)) + underflow_slack +
             8 * detail::near_epsilon * differences.size) *
            (1 + 8 * detail::near_epsilon);
    if (!(differences.size <= detail::largest_size)) upper = std::numeric_limits<double>::infinity();
}

SurfaceTree::SurfaceTree(const PlacedSurface& surface, MemoryMeter* meter)
    : surface_(surface),
      scaled_(surface),
      scaled_points_(meter),
      scale_(tree_scale(surface)),
      tree_(meter),
      small_(meter) {
    const Shape shape = shape_of_surface(surface);
    surface_.box = scaled_.box = box_of_faces(surface);
    if (scale_ != 1) {
        for (std::int64_t v = 0; v < shape.vertices.rows; ++v) scaled_points_.push_back(scale_ * surface.points[v]);
        scaled_.points = scaled_points_.data();
        scaled_.box = {scale_ * surface_.box.low, scale_ * surface_.box.high};
    }
    tree_.build(shape_of_surface(scaled_));
    small_.reserve(static_cast<std::size_t>(tree_.groups()));
    for (std::int32_t g = 0; g < tree_.groups(); ++g) small_.push_back(small_triangles(tree_.group(g)));
}

SurfaceTree::SmallTriangles SurfaceTree::small_triangles(const ShapeTree::Group& group) const {
    SmallTriangles small;
    const SmallFrame& frame = tree_.frame();
    for (int axis = 0; axis < 3; ++axis) {
        const double* of = tree_.vertices(group, axis);
        for (std::size_t k = 0; k < static_cast<std::size_t>(group.count); ++k)
            for (std::size_t c = 0; c < 3; ++c)
                small.corner[c][axis][k] =
                    static_cast<float>((of[group.corner[k][c]] - frame.all.middle[axis]) / frame.unit);
    }
    return small;
}

std::int32_t SurfaceTree::winding_at(const Vec3d& p) const {
    WindingRay ray{p, 0, 0};
    const Bounds along{p, {largest_number, p.y, p.z}};
    for_each_overlap(tree_, Placement(), along, [&](std::int32_t g) {
        const ShapeTree::Group& group = tree_.group(g);
        for (std::size_t k = 0; k < static_cast<std::size_t>(group.count); ++k)
            add_crossing(scaled_, group.element[k], Shift::forward, ray);
    });
    return ray.winding;
}

void PointWalk::find(const Vec3d& p, std::int32_t start) {
    p_ = p;
    const SmallFrame& frame = tree_.frame();
    const Vec3d in_frame = (1 / frame.unit) * (p - frame.all.middle);
    for (int axis = 0; axis < 3; ++axis) in_frame_[axis] = static_cast<float>(in_frame[axis]);
    frame_error_ = 0x1p-19 * max(1.0, largest(abs(in_frame)));
    found_.clear();
    near_.clear();
    set_upper(std::numeric_limits<double>::infinity());
    if (start >= 0) set_upper(GuessedPoint(p, surface_.scaled().corners(start)).upper);
    walk(0);
    std::sort(found_.begin(), found_.end(), [](const Found& x, const Found& y) { return x.triangle < y.triangle; });
    double least = std::numeric_limits<double>::infinity();
    for (const Found& found : found_) {
        if (found.guess.differences.beyond(found.guess.away, upper_ + underflow_slack)) continue;
        if (near_.empty() || found.guess.upper < least) closest_ = near_.size(), least = found.guess.upper;
        near_.push_back({found.triangle, found.points});
    }
}

double PointWalk::lower() const {
    double least = std::numeric_limits<double>::infinity();
    const TrianglePoints point{p_, p_, p_};
    for (const NearTriangle& near : near_) {
        const TriangleGap gap(point, near.points);
        double distance = gap.lower(-1.0 * GuessedPoint(p_, near.points).away);
        // The direction of the guess may be useless for slivers.
        if (distance < (1 - 0x1p-30) * upper_) distance = max(distance, FilteredNearest(point, near.points).lower());
        least = min(least, distance);
    }
    return max(0.0, min(least, upper_) - underflow_slack);
}

// Coordinates in the frame, of magnitude at most 1, and of p are rounded to float32, as are all differences and
// products, so a gap, or a projection on a direction, is wrong by less than frame_error_.
void PointWalk::set_upper(double upper) {
    upper_ = upper;
    const double reach = (upper_ + underflow_slack) / tree_.frame().unit + frame_error_;
    limit_ = static_cast<float>(reach * reach * (1 + 0x1p-17));
}

float PointWalk::squared_gap(std::int32_t node) const {
    const SmallBox& box = tree_.node(node).box;
    float squared = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const float gap = max(0.0F, std::abs(in_frame_[axis] - box.middle[axis]) - box.half[axis]);
        squared += gap * gap;
    }
    return squared;
}

// The closer half comes first.
void PointWalk::walk(std::int32_t node) {
    const ShapeTree::Node& at = tree_.node(node);
    if (at.group >= 0) return visit(at.group);
    const std::int32_t halves[2] = {node + 1, at.right};
    const float gaps[2] = {squared_gap(halves[0]), squared_gap(halves[1])};
    const std::size_t first = gaps[1] < gaps[0];
    for (const std::size_t k : {first, 1 - first})
        if (!(gaps[k] > limit_)) walk(halves[k]);
}

// Drops triangles that are certainly too far away along the direction to their middle: for triangles that are small
// compared with the distance, this is nearly as good as the distance.
void PointWalk::visit(std::int32_t number) {
    const SurfaceTree::SmallTriangles& small = surface_.small(number);
    alignas(64) SurfaceTree::SmallTriangles::Lanes along, length;
    const float x = in_frame_[0], y = in_frame_[1], z = in_frame_[2];
    for (std::size_t k = 0; k < ShapeTree::most_elements; ++k) {
        const Vec3f a = small.vector(0, k, x, y, z), b = small.vector(1, k, x, y, z), c = small.vector(2, k, x, y, z);
        const Vec3f g = a + b + c;
        along[k] = max(0.0F, min(dot(g, a), min(dot(g, b), dot(g, c))));
        length[k] = dot(g, g);
    }
    const ShapeTree::Group& group = tree_.group(number);
    for (std::size_t k = 0; k < static_cast<std::size_t>(group.count); ++k)
        if (!(along[k] * along[k] > limit_ * length[k])) test(group, k);
}

void PointWalk::test(const ShapeTree::Group& group, std::size_t k) {
    const double* const of[3] = {tree_.vertices(group, 0), tree_.vertices(group, 1), tree_.vertices(group, 2)};
    TrianglePoints points;
    for (std::size_t c = 0; c < 3; ++c) {
        const std::uint8_t v = group.corner[k][c];
        points[c] = {of[0][v], of[1][v], of[2][v]};
    }
    const GuessedPoint guess(p_, points);
    if (guess.differences.beyond(guess.away, upper_ + underflow_slack)) return;
    found_.push_back({group.element[k], guess, points});
    if (guess.upper < upper_) set_upper(guess.upper);
}

}  // namespace crumple
