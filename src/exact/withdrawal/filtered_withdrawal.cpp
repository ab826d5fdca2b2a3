#include "exact/withdrawal/filtered_withdrawal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "exact/overlap/crossing.h"
#include "exact/overlap/enclosed.h"

namespace crumple {
namespace {

/// Returns the sign, 0 if the number is certainly 0, or 2 if its sign is not certain.
int sign_if_certain(const Enclosed& x) {
    if (x.error == 0 || x.magnitude() * (1 - 0x1p-40) > x.error) return (x.value.high > 0) - (x.value.high < 0);
    return 2;
}

/// Returns a float64 that is at least every number that x may be, and exceeds x.value by little more than x.error.
double upper_end(const Enclosed& x) {
    const double low = x.value.low + x.error;
    const TwoTerms sum = two_sum(x.value.high, x.error == 0 ? low : low + 0x1p-52 * (std::abs(low) + x.error));
    return sum.low > 0 ? std::nextafter(sum.high, std::numeric_limits<double>::infinity()) : sum.high;
}
double lower_end(const Enclosed& x) { return -upper_end(-x); }

using Vector = Vec3<Enclosed>;

Vector enclosed(const Vec3d& p) { return {Enclosed(p.x), Enclosed(p.y), Enclosed(p.z)}; }

/// Bounds on the t at which pairs of features meet (GreatestParameter in exact_withdrawal.cpp).
///
/// A turn is det(direction, edge, p − start of the edge): the side of p on which the edge passes it, as seen along the
/// direction. Features certainly do not meet if such signs separate them. If features may meet, but may be parallel to
/// each other or to the direction, the bound is that of their coordinates along the axis.
class FeatureBounds {
   public:
    FeatureBounds(const FaceCorners& a, const FaceCorners& b, const Vec3d& direction, int axis);

    WithdrawalBounds greatest();

   private:
    using Signs = std::array<std::array<int, 3>, 3>;  ///< signs of turns: by vertex, then edge of the other triangle

    bool are_apart() const;
    void meet_planes();
    void add_vertex_and_face(std::size_t vertex, std::size_t side);
    void add_edges(std::size_t i, std::size_t j);
    void add(const Enclosed& t, double most, bool is_certain);
    double most_between(double a, double b) const { return upper_end(Enclosed::difference(a, b) / step_); }
    double height(const Vec3d& p) const { return direction_[axis_] > 0 ? p[axis_] : -p[axis_]; }

    const std::array<const FaceCorners*, 2> corners_;
    const Vec3d& direction_;
    const Vector d_;  ///< the direction
    const int axis_;
    const Enclosed step_;  ///< length of the direction along the axis
    std::array<std::array<Vector, 3>, 2> edge_;
    std::array<Vector, 2> normal_;
    std::array<Enclosed, 2> along_;  ///< normal · direction
    std::array<Signs, 2> turn_;      ///< heights of the vertices of each triangle
    std::array<std::array<double, 3>, 2> height_;
    /// t at which the vertices of each triangle meet the plane of the other one. If two features meet, their t is at
    /// most the greatest of these t of the vertices of either feature.
    std::array<std::array<Enclosed, 3>, 2> plane_;
    std::array<std::array<double, 3>, 2> plane_above_;
    WithdrawalBounds bounds_;
};

FeatureBounds::FeatureBounds(const FaceCorners& a, const FaceCorners& b, const Vec3d& direction, int axis)
    : corners_{&a, &b}, direction_(direction), d_(enclosed(direction)), axis_(axis), step_(std::abs(direction[axis])) {
    for (std::size_t side = 0; side < 2; ++side) {
        const FaceCorners &p = *corners_[side], &q = *corners_[1 - side];
        for (std::size_t k = 0; k < 3; ++k) {
            edge_[side][k] = enclosed_difference(p[next_corner(k)], p[k]);
            height_[side][k] = height(p[k]);
            const Vector across = cross(d_, edge_[side][k]);
            for (std::size_t i = 0; i < 3; ++i)
                turn_[1 - side][i][k] = sign_if_certain(dot(across, enclosed_difference(q[i], p[k])));
        }
        normal_[side] = cross(edge_[side][0], edge_[side][1]);
        along_[side] = dot(normal_[side], d_);
    }
}

/// True if an edge of a triangle certainly separates the triangles, as seen along the direction.
bool FeatureBounds::are_apart() const {
    for (std::size_t side = 0; side < 2; ++side) {
        const int inside = sign_if_certain(along_[side]);
        if (inside == 0 || inside == 2) continue;
        const Signs& turns = turn_[1 - side];
        for (std::size_t k = 0; k < 3; ++k)
            if (turns[0][k] == -inside && turns[1][k] == -inside && turns[2][k] == -inside) return true;
    }
    return false;
}

void FeatureBounds::meet_planes() {
    for (std::size_t side = 0; side < 2; ++side) {
        const std::size_t other = 1 - side;
        const Vec3d& q = (*corners_[other])[0];
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3d& p = (*corners_[side])[k];
            const Vector between = side == 0 ? enclosed_difference(p, q) : enclosed_difference(q, p);
            plane_[side][k] = dot(normal_[other], between) / along_[other];
            plane_above_[side][k] = std::isfinite(plane_[side][k].error) ? upper_end(plane_[side][k])
                                                                         : std::numeric_limits<double>::infinity();
        }
    }
}

void FeatureBounds::add(const Enclosed& t, double most, bool is_certain) {
    const bool is_finite = std::isfinite(t.error);
    bounds_.upper = std::max(bounds_.upper, is_finite ? std::min(most, upper_end(t)) : most);
    if (is_certain && is_finite) bounds_.lower = std::max(bounds_.lower, lower_end(t));
}

// The vertex belongs to triangle `side`, the face is the other triangle.
void FeatureBounds::add_vertex_and_face(std::size_t vertex, std::size_t side) {
    const std::array<int, 3>& turns = turn_[side][vertex];
    const auto any = [&](int sign) { return std::find(turns.begin(), turns.end(), sign) != turns.end(); };
    if (any(1) && any(-1)) return;
    const std::array<double, 3>& heights = height_[1 - side];
    const double own = height_[side][vertex];
    const double most = side == 0 ? most_between(own, std::min({heights[0], heights[1], heights[2]}))
                                  : most_between(std::max({heights[0], heights[1], heights[2]}), own);
    add(plane_[side][vertex], most, !any(2));
}

void FeatureBounds::add_edges(std::size_t i, std::size_t j) {
    const std::size_t i_end = next_corner(i), j_end = next_corner(j);
    const std::array turns{turn_[0][i][j], turn_[0][i_end][j], turn_[1][j][i], turn_[1][j_end][i]};
    const auto on_one_side = [](int x, int y) { return x == y && (x == 1 || x == -1); };
    if (on_one_side(turns[0], turns[1]) || on_one_side(turns[2], turns[3])) return;
    const double most = std::min(
        {most_between(std::max(height_[0][i], height_[0][i_end]), std::min(height_[1][j], height_[1][j_end])),
         std::max(plane_above_[0][i], plane_above_[0][i_end]), std::max(plane_above_[1][j], plane_above_[1][j_end])});
    if (most <= bounds_.lower) return;
    const Vector normal = cross(edge_[0][i], edge_[1][j]);
    const bool is_certain = std::find(turns.begin(), turns.end(), 2) == turns.end();
    add(dot(normal, enclosed_difference((*corners_[0])[i], (*corners_[1])[j])) / dot(normal, d_), most, is_certain);
}

WithdrawalBounds FeatureBounds::greatest() {
    if (are_apart()) return bounds_;
    meet_planes();
    for (std::size_t vertex = 0; vertex < 3; ++vertex)
        for (std::size_t side = 0; side < 2; ++side) add_vertex_and_face(vertex, side);
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) add_edges(i, j);
    return bounds_;
}

}  // namespace

WithdrawalBounds enclose_withdrawal(const FaceCorners& a, const FaceCorners& b, const Vec3d& direction, int axis) {
    return FeatureBounds(a, b, direction, axis).greatest();
}

}  // namespace crumple
