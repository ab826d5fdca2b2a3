#include "results/joined_curves.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "exact/integer.h"

namespace crumple {
namespace {

/// End of a segment, where the edge between vertices `low` and `high` of surface `side` crosses face `crossed` of the
/// other surface.
struct CurveEnd {
    std::size_t side;  ///< surface of the edge: 0 or 1
    std::int32_t low, high, crossed;
    std::int32_t segment;
    std::int32_t face;  ///< face of surface `side` with that edge, in which the segment lies
    bool is_start;
    bool upward;  ///< true if that face traverses its edge from the lower to the higher vertex

    auto crossing() const { return std::tie(side, low, high, crossed); }
};

CurveEnd end_of(const Segment& segment, std::size_t index, bool is_start, const FaceReader& face) {
    const SegmentEnd& end = is_start ? segment.start : segment.end;
    const std::int32_t own = end.side == 0 ? segment.a : segment.b, crossed = end.side == 0 ? segment.b : segment.a;
    const auto vertex = face(end.side, own).vertex;
    const std::int32_t from = vertex[end.edge], to = vertex[next_corner(end.edge)];
    return {end.side, std::min(from, to), std::max(from, to), crossed, static_cast<std::int32_t>(index),
            own,      is_start,           from < to};
}

/// Order of faces around an edge, counter-clockwise about the direction from its lower to its higher vertex.
class FacesAroundEdge {
   public:
    FacesAroundEdge(std::span<const CurveEnd> ends, const FaceReader& face) {
        std::vector<Vec3d> points;
        for (const CurveEnd& end : ends) {
            const FaceOfSurface f = face(end.side, end.face);
            for (std::size_t k = 0; k < 3; ++k) {
                if (f.vertex[k] == end.low) low_ = f.corner[k];
                if (f.vertex[k] == end.high) high_ = f.corner[k];
            }
            const auto apex = std::find_if(f.vertex.begin(), f.vertex.end(),
                                           [&](std::int32_t v) { return v != end.low && v != end.high; });
            points.push_back(apex == f.vertex.end() ? low_
                                                    : f.corner[static_cast<std::size_t>(apex - f.vertex.begin())]);
        }
        points.push_back(low_);
        points.push_back(high_);
        const int exponent = common_exponent(points);
        const Vec3<Integer> origin = in_units(low_, exponent), axis = in_units(high_, exponent) - origin;
        for (std::size_t i = 0; i < ends.size(); ++i)
            normals_.push_back(cross(axis, in_units(points[i], exponent) - origin));  // normal of the half-plane
        axis_ = axis;
        const auto proper = std::find_if(normals_.begin(), normals_.end(), [](const auto& n) { return !is_zero(n); });
        if (proper != normals_.end()) first_ = *proper;
    }

    /// Returns the indices of the ends in that order; degenerate faces, which have no direction, are last.
    std::vector<std::size_t> order() const {
        std::vector<std::size_t> order(normals_.size());
        for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
        std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
            const Vec3<Integer>&m = normals_[i], &n = normals_[j];
            if (half(m) != half(n)) return half(m) < half(n);
            return half(m) < 2 && turn(m, n) > 0;
        });
        return order;
    }

   private:
    static bool is_zero(const Vec3<Integer>& v) { return v == Vec3<Integer>{}; }
    int turn(const Vec3<Integer>& m, const Vec3<Integer>& n) const { return dot(cross(m, n), axis_).sign(); }
    /// Returns 0 for a face less than half a turn after the first one, 1 for a later one, 2 for one without a
    /// direction.
    int half(const Vec3<Integer>& n) const {
        if (is_zero(n)) return 2;
        const int side = turn(first_, n);
        return side != 0 ? side < 0 : dot(first_, n) < 0;
    }

    Vec3d low_, high_;
    Vec3<Integer> axis_, first_;
    std::vector<Vec3<Integer>> normals_;
};

/// Next and previous segment of each segment; −1: none.
struct Chains {
    std::vector<std::int32_t> next, previous;

    void join(const CurveEnd& one, const CurveEnd& other) {
        const CurveEnd &end = one.is_start ? other : one, &start = one.is_start ? one : other;
        next[static_cast<std::size_t>(end.segment)] = start.segment;
        previous[static_cast<std::size_t>(start.segment)] = end.segment;
    }
};

// Joins the segments whose ends are one crossing of an edge. Going around the edge, a solid begins at a face that
// traverses the edge downward and ends at one that traverses it upward. Matches the two kinds of faces like opening and
// closing brackets on a circle.
void join_at(std::span<const CurveEnd> ends, const FaceReader& face, Chains& chains) {
    if (ends.size() == 2) {
        if (ends[0].is_start != ends[1].is_start) chains.join(ends[0], ends[1]);
        return;
    }
    if (ends.size() < 2) return;
    const std::vector<std::size_t> order = FacesAroundEdge(ends, face).order();
    std::vector<const CurveEnd*> open;
    std::vector<std::uint8_t> joined(ends.size());
    for (const bool again : {false, true})
        for (const std::size_t i : order) {
            if (joined[i]) continue;
            if (!ends[i].upward) {
                if (!again) open.push_back(&ends[i]);
            } else if (!open.empty()) {
                chains.join(*open.back(), ends[i]);
                joined[i] = 1;
                open.pop_back();
            }
        }
}

}  // namespace

std::vector<JoinedCurve> join_segments(std::span<const Segment> segments, std::size_t links, const FaceReader& face) {
    std::vector<CurveEnd> ends;
    ends.reserve(2 * segments.size());
    for (std::size_t i = 0; i < segments.size(); ++i)
        for (const bool is_start : {true, false}) ends.push_back(end_of(segments[i], i, is_start, face));
    std::sort(ends.begin(), ends.end(), [](const CurveEnd& x, const CurveEnd& y) {
        return std::tuple_cat(x.crossing(), std::tie(x.segment, x.is_start)) <
               std::tuple_cat(y.crossing(), std::tie(y.segment, y.is_start));
    });
    Chains chains{std::vector<std::int32_t>(segments.size(), -1), std::vector<std::int32_t>(segments.size(), -1)};
    for (std::size_t i = 0, end = 0; i < ends.size(); i = end) {
        while (end < ends.size() && ends[end].crossing() == ends[i].crossing()) ++end;
        join_at(std::span(ends).subspan(i, end - i), face, chains);
    }

    std::vector<JoinedCurve> curves;
    std::vector<std::uint8_t> visited(segments.size());
    const auto lowest = static_cast<std::int32_t>(links);
    for (std::int32_t i = 0; i < lowest; ++i) {
        if (visited[static_cast<std::size_t>(i)]) continue;
        std::int32_t first = i;
        const auto before = [&](std::int32_t s) { return chains.previous[static_cast<std::size_t>(s)]; };
        while (before(first) >= 0 && before(first) != i) first = before(first);
        JoinedCurve& curve = curves.emplace_back();
        curve.closed = before(first) == i;
        if (curve.closed) first = i;
        std::int32_t s = first;
        do {
            visited[static_cast<std::size_t>(s)] = 1;
            if (s < lowest) curve.segments.push_back(s);
            s = chains.next[static_cast<std::size_t>(s)];
        } while (s >= 0 && s != first);
    }
    return curves;
}

}  // namespace crumple
