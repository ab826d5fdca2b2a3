// Joins the segments in which faces cross to curves (results/joined_curves.h), and computes their points; each
// coordinate is correctly rounded.

#include <algorithm>
#include <limits>

#include "exact/overlap/rational_sum.h"
#include "results/joined_curves.h"
#include "search/overlap/overlap_enclosed.h"
#include "search/overlap/overlap_row.h"

namespace crumple {
namespace {

/// Computes the point at which an edge crosses a face, each coordinate correctly rounded.
class RoundedCrossing {
   public:
    RoundedCrossing(bool in_range, Cancellation& cancellation) : in_range_(in_range), cancellation_(cancellation) {}

    bool was_exact = false;

    Vec3d operator()(const CrossingEdge& edge) {
        Vec3d point;
        for (int axis = 0; axis < 3; ++axis) point[axis] = edge.from[axis] + 0.0;  // never -0
        if (edge.is_vertex()) return point;
        if (in_range_) {
            const Enclosed share = enclosed_parameter(edge);
            bool certain = true;
            for (int axis = 0; axis < 3; ++axis) {
                const Enclosed x =
                    Enclosed(edge.from[axis]) + share * Enclosed::difference(edge.to[axis], edge.from[axis]);
                const auto rounded = nearest_quotient(x, 1);
                certain = certain && rounded;
                if (rounded) point[axis] = *rounded;
            }
            if (certain) return point;
        }
        was_exact = true;
        const Rational share = edge_parameter(edge.from, edge.to, edge.face);
        for (int axis = 0; axis < 3; ++axis) {
            RationalSum sum;
            sum.add(Rational(edge.from[axis]));
            sum.add(share * (Rational(edge.to[axis]) - Rational(edge.from[axis])));
            point[axis] = sum.rounded_quotient(1, cancellation_).value;
        }
        return point;
    }

   private:
    bool in_range_;
    Cancellation& cancellation_;
};

}  // namespace

OverlapOfBodies::ForwardSegments OverlapOfBodies::forward_segments() const {
    ForwardSegments forward;
    std::copy_if(sums_.segments.begin(), sums_.segments.end(), std::back_inserter(forward.segments),
                 [](const Segment& segment) { return segment.in_volume; });
    forward.links = forward.segments.size();
    forward.segments.insert(forward.segments.end(), links_.begin(), links_.end());
    return forward;
}

FaceReader OverlapOfBodies::face_reader() const {
    return [this](std::size_t side, std::int32_t face) {
        const std::int32_t* c = topology(side).corners(face);
        return FaceOfSurface{{c[0], c[1], c[2]}, body(side).corners(face)};
    };
}

std::vector<OverlapCurve> OverlapOfBodies::curves(const Vec3d& point) {
    const auto joined = join_segments(forward_.segments, forward_.links, face_reader());

    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    std::vector<OverlapCurve> curves(joined.size());
    RoundedCrossing round(in_range(), cancellation_);
    for (std::size_t i = 0; i < joined.size(); ++i) {
        OverlapCurve& curve = curves[i];
        curve.closed = joined[i].closed;
        if (!region_of_segment_.empty())
            curve.region = region_of_segment_[static_cast<std::size_t>(joined[i].segments[0])];
        OverlapSums sums = sums_of_surfaces();
        sums.numbers = true;
        for (const std::int32_t s : joined[i].segments) {
            cancellation_.check();
            Segment segment = forward_.segments[static_cast<std::size_t>(s)];
            curve.points.push_back(round(crossing_edge(sums_.surfaces, segment, segment.start)));
            curve.triangles.push_back({segment.a, segment.b});
            segment.times = 2;
            segment.in_volume = false;
            sums.segments.push_back(segment);
        }
        curve.points.push_back(round(crossing_edge(sums_.surfaces, sums.segments.back(), sums.segments.back().end)));
        curve.area_vector = curve.torque = {nan, nan, nan};
        if (!curve.closed) continue;
        const CurveNumbers numbers = finish_curves(sums, sums_.surfaces.origin, point);
        curve.area_vector = CurveNumbers::values(numbers.area);
        curve.torque = CurveNumbers::values(numbers.torque);
        was_exact_ |= sums.was_exact();
    }
    was_exact_ |= round.was_exact;
    return curves;
}

}  // namespace crumple
