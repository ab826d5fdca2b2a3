#include "exact/distance/nearest_triangle.h"

#include <algorithm>
#include <utility>

#include "exact/distance/closest_parts.h"
#include "exact/distance/exact_nearest.h"
#include "exact/overlap/enclosed.h"

namespace crumple {
namespace {

/// Closest point a + s (b - a) + t (c - a) of a vertex, an edge or a face, in double words with error bounds.
class EnclosedPoint {
   public:
    /// `features`: a vertex p, and a vertex, an edge or a face, of which no smaller part may be the closest. is_valid()
    /// is false if that is not certain.
    explicit EnclosedPoint(const Features& features) {
        const auto& [p, a, b, c] = features.point;
        first_ = a;
        w_ = enclosed_difference(p, a);
        if (features.kinds != FeatureKinds::vertex_vertex) u_ = enclosed_difference(b, a);
        if (features.kinds == FeatureKinds::vertex_face) v_ = enclosed_difference(c, a);
        if (features.kinds == FeatureKinds::vertex_edge) find_on_edge();
        if (features.kinds == FeatureKinds::vertex_face) find_on_face();
    }
    bool is_valid() const { return is_valid_; }

    std::optional<double> distance() const {
        const Vec3<Enclosed> away = w_ - (s_ * u_ + t_ * v_);
        return nearest_quotient(sqrt(dot(away, away)), 1);
    }
    std::optional<double> coordinate(int axis) const {
        return nearest_quotient(Enclosed(first_[axis]) + (s_ * u_[axis] + t_ * v_[axis]), 1);
    }

   private:
    /// True if x is certainly positive, and so large that its products do not underflow.
    static bool is_positive(const Enclosed& x) {
        constexpr double least_share = 0x1p-250;
        return x.value.high >= least_share && x.value.high > 2 * x.error;
    }
    void find_on_edge() {
        s_ = dot(w_, u_) / dot(u_, u_);
        is_valid_ = is_positive(s_) && is_positive(Enclosed(1.0) - s_);
    }
    void find_on_face() {
        const Enclosed uu = dot(u_, u_), uv = dot(u_, v_), vv = dot(v_, v_), wu = dot(w_, u_), wv = dot(w_, v_);
        const Enclosed area = uu * vv - uv * uv;
        s_ = (wu * vv - wv * uv) / area;
        t_ = (wv * uu - wu * uv) / area;
        is_valid_ = is_positive(s_) && is_positive(t_) && is_positive(Enclosed(1.0) - (s_ + t_));
    }

    Vec3d first_;
    Vec3<Enclosed> w_, u_, v_;
    Enclosed s_, t_;
    bool is_valid_ = true;
};

/// Returns the closest triangle if double words are certain of it: the closest parts of all triangles are the same.
std::optional<NearestTriangle> decide_by_filter(const Vec3d& p, std::span<const NearTriangle> near,
                                                std::size_t closest) {
    const TrianglePoints point{p, p, p}, &triangle = near[closest].points;
    const ClosestParts parts(point, triangle, FilteredNearest(point, triangle));
    for (const NearTriangle& other : near)
        if (!parts.are_closest_of(point, other.points)) return std::nullopt;
    const Features features = parts.features();
    if (parts.second_comes_first() || features.kinds == FeatureKinds::edge_edge) return std::nullopt;
    const EnclosedPoint on_part(features);
    if (!on_part.is_valid()) return std::nullopt;
    const std::optional<double> distance = on_part.distance();
    if (!distance) return std::nullopt;
    NearestTriangle nearest{near[0].triangle, *distance, {}};
    for (int axis = 0; axis < 3; ++axis) {
        const std::optional<double> rounded = on_part.coordinate(axis);
        if (!rounded) return std::nullopt;
        nearest.point[axis] = *rounded;
    }
    return nearest;
}

std::optional<NearestTriangle> decide_rationally(const Vec3d& p, std::span<const NearTriangle> near,
                                                 Cancellation& cancellation) {
    std::size_t least = 0;
    RationalDistance distance(vertex_and_face(p, near[0].points));
    for (std::size_t i = 1; i < near.size() && !distance.touching(); ++i) {
        cancellation.check();
        RationalDistance other(vertex_and_face(p, near[i].points));
        if (compare(other, distance) >= 0) continue;
        least = i;
        distance = std::move(other);
    }
    if (distance.touching()) return std::nullopt;
    const Vec3d point = closest_points(vertex_and_face(p, near[least].points), distance)[1];
    return NearestTriangle{near[least].triangle, distance.rounded(), point};
}

}  // namespace

std::optional<NearestTriangle> decide_nearest(const Vec3d& p, std::span<const NearTriangle> near, std::size_t closest,
                                              bool in_range, Cancellation& cancellation, std::int64_t& rational) {
    const auto has_corner = [&](const NearTriangle& other) {
        return std::find(other.points.begin(), other.points.end(), p) != other.points.end();
    };
    if (std::any_of(near.begin(), near.end(), has_corner)) return std::nullopt;
    if (in_range)
        if (const auto nearest = decide_by_filter(p, near, closest)) return nearest;
    ++rational;
    return decide_rationally(p, near, cancellation);
}

}  // namespace crumple
