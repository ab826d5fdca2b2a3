#include "results/overlap_face_loops.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "exact/overlap/enclosed_parameter.h"
#include "geometry/predicates.h"

namespace crumple {
namespace {

/// Returns the sign of a number that is not certainly 0, or 2 if the sign is not certain.
int certain_sign(const Enclosed& x) {
    constexpr int uncertain = 2;
    if (!(x.magnitude() > (1 + 0x1p-40) * x.error)) return uncertain;
    return x.value.high > 0 ? 1 : -1;
}

/// Returns the determinant (q − p) × (r − p).
template <class Number>
Number turn(const std::array<Number, 2>& p, const std::array<Number, 2>& q, const std::array<Number, 2>& r) {
    return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
}

/// Position at which the line from `low` to `high` reaches the height y: numerator / denominator, which is positive.
template <class Number>
struct PositionAtHeight {
    Number numerator, denominator;

    PositionAtHeight(const std::array<Number, 2>& low, const std::array<Number, 2>& high, const Number& y)
        : numerator(low[0] * (high[1] - low[1]) + (high[0] - low[0]) * (y - low[1])), denominator(high[1] - low[1]) {}
};

}  // namespace

FaceLoops::FaceLoops(std::size_t side, const FaceCorners& face, std::vector<SegmentOnFace> segments,
                     const std::array<std::vector<CrossedEdge>, 3>& crossings, bool in_range)
    : side_(side), in_range_(in_range), segments_(std::move(segments)) {
    std::stable_sort(segments_.begin(), segments_.end(),
                     [](const SegmentOnFace& x, const SegmentOnFace& y) { return x.chain < y.chain; });
    // Projects along the greatest component of the normal, computed from coordinates between -1 and 1.
    double size = 0;
    for (std::size_t k = 1; k < 3; ++k)
        for (int i = 0; i < 3; ++i) size = std::max(size, std::abs(0.5 * face[k][i] - 0.5 * face[0][i]));
    const auto edge = [&](std::size_t k) {
        Vec3d d;
        for (int i = 0; i < 3; ++i) d[i] = (0.5 * face[k][i] - 0.5 * face[0][i]) / size;
        return d;
    };
    const Vec3d normal = abs(cross(edge(1), edge(2)));
    dropped_ = normal.x > normal.y ? (normal.x > normal.z ? 0 : 2) : (normal.y > normal.z ? 1 : 2);
    for (int tried = 0; tried < 3; ++tried, dropped_ = first_axis(dropped_)) {
        for (std::size_t k = 0; k < 3; ++k) corner_[k] = at(face[k]);
        const int sign = orientation(corner_[0], corner_[1], corner_[2]);
        mirrored_ = sign < 0;
        if (sign != 0) break;
    }
    for (const SegmentOnFace& segment : segments_) {
        start_.push_back(at(segment.start));
        end_.push_back(at(segment.end));
    }
    for (std::size_t edge = 0; edge < 3; ++edge)
        for (const CrossedEdge& crossing : crossings[edge]) crossings_[edge].push_back(at(crossing));
    sort_into_bands();
}

// The number of bands is such that a segment is in a few of them on average.
void FaceLoops::sort_into_bands() {
    struct Heights {
        double low, high;
    };
    std::vector<Heights> heights;
    double low = std::numeric_limits<double>::infinity(), high = -low, sum = 0;
    for (std::size_t i = 0; i < segments_.size() && in_range_; ++i) {
        const Enclosed &p = start_[i].x[1], &q = end_[i].x[1];
        const double error = p.error + q.error + 0x1p-50 * (p.magnitude() + q.magnitude());
        heights.push_back({min(p.value.high, q.value.high) - error, max(p.value.high, q.value.high) + error});
        low = min(low, heights.back().low), high = max(high, heights.back().high);
        sum += heights.back().high - heights.back().low;
    }
    const auto n = static_cast<double>(segments_.size());
    const double height = max((high - low) / n, sum / (4 * n));
    if (!in_range_ || !(height > 0) || !std::isfinite(height)) {
        bands_.resize(1);
        for (std::uint32_t i = 0; i < segments_.size(); ++i) bands_[0].push_back(i);
        return;
    }
    first_height_ = low;
    band_height_ = height;
    bands_.resize(static_cast<std::size_t>((high - low) / height) + 2);
    for (std::uint32_t i = 0; i < segments_.size(); ++i)
        for (std::size_t band = band_at(heights[i].low); band <= band_at(heights[i].high); ++band)
            bands_[band].push_back(i);
}

std::size_t FaceLoops::band_at(double height) const {
    if (band_height_ == 0) return 0;
    const double band = (height - first_height_) / band_height_;
    return std::min(static_cast<std::size_t>(max(band, 0.0)), bands_.size() - 1);
}

int FaceLoops::axis(int coordinate) const { return coordinate == 0 ? first_axis(dropped_) : second_axis(dropped_); }

FaceLoops::Point FaceLoops::at(const CrossedEdge& crossing) const {
    Point point{{}, crossing, {}};
    if (!in_range_) return point;
    const Enclosed share = enclosed_parameter(crossing.from, crossing.to, crossing.face);
    for (int i = 0; i < 2; ++i) {
        const int k = axis(i);
        point.x[static_cast<std::size_t>(i)] =
            Enclosed(crossing.from[k]) + share * Enclosed::difference(crossing.to[k], crossing.from[k]);
    }
    return point;
}

FaceLoops::Point FaceLoops::at(const Vec3d& vertex) const {
    return {{Enclosed(vertex[axis(0)]), Enclosed(vertex[axis(1)])}, std::nullopt, vertex};
}

ShiftedNumber FaceLoops::shifted(int coordinate, const Point& p) const {
    if (!p.shifted) p.shifted = p.crossing ? shifted_point(*p.crossing) : shifted_vertex(p.vertex, side_);
    return (*p.shifted)[axis(coordinate)];
}

// Returns the sign of a coordinate of p minus that of q.
int FaceLoops::compare(int coordinate, const Point& p, const Point& q) const {
    const auto i = static_cast<std::size_t>(coordinate);
    if (in_range_)
        if (const int sign = certain_sign(p.x[i] - q.x[i]); sign != 2) return sign;
    // On an edge across the coordinate, all points have the same one.
    const int k = axis(coordinate);
    const auto is_across = [&](const Point& point) {
        return point.crossing && point.crossing->from[k] == point.crossing->to[k];
    };
    if (is_across(p) && is_across(q) && p.crossing->side == q.crossing->side)
        return (p.crossing->from[k] > q.crossing->from[k]) - (p.crossing->from[k] < q.crossing->from[k]);
    return (shifted(coordinate, p) - shifted(coordinate, q)).sign();
}

// Returns 1 if p, q, r turn counter-clockwise in the projection, −1 if clockwise, 0 if they are on a line.
int FaceLoops::orientation(const Point& p, const Point& q, const Point& r) const {
    if (in_range_)
        if (const int sign = certain_sign(turn(p.x, q.x, r.x)); sign != 2) return sign;
    const auto both = [&](const Point& point) { return std::array{shifted(0, point), shifted(1, point)}; };
    return turn(both(p), both(q), both(r)).sign();
}

// True if the ray meets segment i before segment j.
bool FaceLoops::is_nearer(std::size_t i, std::size_t j) const {
    const auto sign = [&](auto coordinates) {
        const auto y = coordinates(*origin_)[1];
        const auto position = [&](std::size_t k) {
            const bool upward = compare(1, end_[k], start_[k]) > 0;
            return PositionAtHeight(coordinates(upward ? start_[k] : end_[k]),
                                    coordinates(upward ? end_[k] : start_[k]), y);
        };
        const auto p = position(i), q = position(j);
        return p.numerator * q.denominator - q.numerator * p.denominator;
    };
    if (in_range_)
        if (const int s = certain_sign(sign([](const Point& p) { return p.x; })); s != 2) return s < 0;
    return sign([&](const Point& p) { return std::array{shifted(0, p), shifted(1, p)}; }).sign() < 0;
}

// True if the ray meets the line from p to q; sets `upward`.
bool FaceLoops::ray_meets(const Point& p, const Point& q, bool& upward) const {
    const bool p_above = compare(1, p, *origin_) > 0;
    upward = compare(1, q, *origin_) > 0;
    return p_above != upward && (upward ? orientation(p, q, *origin_) : orientation(q, p, *origin_)) > 0;
}

Surroundings FaceLoops::around(std::int32_t chain) {
    const auto [first, last] =
        std::equal_range(segments_.begin(), segments_.end(), SegmentOnFace{0, chain, {}, {}},
                         [](const SegmentOnFace& x, const SegmentOnFace& y) { return x.chain < y.chain; });
    const auto begin = static_cast<std::size_t>(first - segments_.begin()),
               end = static_cast<std::size_t>(last - segments_.begin());
    origin_ = &start_[begin];
    for (std::size_t i = begin; i < end; ++i)
        if (compare(0, start_[i], *origin_) > 0) origin_ = &start_[i];

    Surroundings found;
    bool upward = false, leaves_upward = false;
    for (std::size_t edge = 0; edge < 3; ++edge)
        if (ray_meets(corner_[edge], corner_[next_corner(edge)], upward)) {
            found.edge = edge;
            leaves_upward = upward;
        }
    const std::vector<Point>& on_edge = crossings_[found.edge];
    const auto is_before = [&](const Point& p) { return (compare(1, p, *origin_) > 0) != leaves_upward; };
    found.before =
        static_cast<std::size_t>(std::partition_point(on_edge.begin(), on_edge.end(), is_before) - on_edge.begin());

    std::optional<std::size_t> nearest;
    for (const std::uint32_t i : bands_[band_at(origin_->x[1].value.high)]) {
        if (segments_[i].chain == chain || !ray_meets(start_[i], end_[i], upward)) continue;
        // The winding number is greater by 1 to the left of the segment.
        found.change += upward != mirrored_ ? 1 : -1;
        if (!nearest || is_nearer(i, *nearest)) nearest = i;
    }
    if (nearest) found.segment = segments_[*nearest].segment;
    return found;
}

}  // namespace crumple
