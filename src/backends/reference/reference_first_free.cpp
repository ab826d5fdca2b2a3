#include "backends/reference/reference_first_free.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <set>
#include <utility>
#include <vector>

#include "exact/withdrawal/exact_withdrawal.h"
#include "exact/withdrawal/sheared_face.h"

namespace crumple {
namespace {

/// Segment of the plane; u of `from` is less than u of `to`.
struct PlaneSegment {
    ShearedPlace from, to;

    Rational v_at(const Rational& u) const { return from.v + (u - from.u) / (to.u - from.u) * (to.v - from.v); }
};

/// Open interval of t.
struct OpenInterval {
    Rational low, high;
};

/// Inside interval of a body on all lines through a trapezoid: indices of the faces at its ends.
struct FaceInterval {
    std::size_t bottom, top;
};

using Corners = std::array<ShearedPlace, 4>;

/// Sweeps the plane.
class OverlapIntervals {
   public:
    OverlapIntervals(const PosedBody& a, const PosedBody& b, const Shear& shear, Cancellation& cancellation)
        : cancellation_(cancellation) {
        for (std::size_t body = 0; body < 2; ++body) {
            const PosedBody& of = body == 0 ? a : b;
            for (std::size_t f = 0; f < of.face.size(); ++f)
                if (const ShearedFace face(of.corners(f), shear); !face.is_upright()) faces_[body].push_back(face);
        }
    }

    std::vector<OpenInterval> find() {
        if (faces_[0].empty() || faces_[1].empty()) return {};
        for (const auto& faces : faces_) add_segments(faces);
        add_borders_at_crossings();
        const std::vector<Rational> borders(borders_.begin(), borders_.end());
        for (std::size_t i = 0; i + 1 < borders.size(); ++i) sweep_slab(borders[i], borders[i + 1]);
        return std::move(intervals_);
    }

   private:
    void add_segment(const ShearedPlace& p, const ShearedPlace& q) {
        borders_.insert(p.u);
        borders_.insert(q.u);
        if (p.u != q.u) segments_.push_back(p.u < q.u ? PlaneSegment{p, q} : PlaneSegment{q, p});
    }

    /// Adds the edges of faces of one body, and the segments in which its faces cross.
    void add_segments(const std::vector<ShearedFace>& faces) {
        for (std::size_t i = 0; i < faces.size(); ++i) {
            for (std::size_t k = 0; k < 3; ++k) add_segment(faces[i].place(k), faces[i].place((k + 1) % 3));
            for (std::size_t j = 0; j < i; ++j) add_crossing(faces[i], faces[j]);
        }
    }

    void add_crossing(const ShearedFace& f, const ShearedFace& g) {
        const std::vector<ShearedPlace> corners = PlacePolygon(f, g).corners();
        std::vector<ShearedPlace> ends;
        const auto above = [&](const ShearedPlace& p) { return f.height(p) - g.height(p); };
        for (std::size_t k = 0; k < corners.size(); ++k) {
            const ShearedPlace &p = corners[k], &q = corners[(k + 1) % corners.size()];
            const Rational start = above(p), end = above(q);
            if (start == 0) ends.push_back(p);
            if ((start > 0 && end < 0) || (start < 0 && end > 0)) ends.push_back(p + start / (start - end) * (q - p));
        }
        if (ends.size() == 2) add_segment(ends[0], ends[1]);
    }

    void add_borders_at_crossings() {
        std::sort(segments_.begin(), segments_.end(), [](const PlaneSegment& s, const PlaneSegment& t) {
            const BeforeInPlane before;
            return before(s.from, t.from) || (s.from == t.from && before(s.to, t.to));
        });
        const auto is_same = [](const PlaneSegment& s, const PlaneSegment& t) {
            return s.from == t.from && s.to == t.to;
        };
        segments_.erase(std::unique(segments_.begin(), segments_.end(), is_same), segments_.end());
        for (std::size_t i = 0; i < segments_.size(); ++i)
            for (std::size_t j = 0; j < i; ++j) {
                const PlaneSegment &s = segments_[i], &t = segments_[j];
                const ShearedPlace along = s.to - s.from, other = t.to - t.from;
                const Rational divisor = cross(along, other);
                if (divisor == 0) continue;
                const Rational share = cross(t.from - s.from, other) / divisor,
                               other_share = cross(t.from - s.from, along) / divisor;
                if (share > 0 && share < 1 && other_share >= 0 && other_share <= 1)
                    borders_.insert(s.from.u + share * along.u);
                else if (other_share > 0 && other_share < 1 && share >= 0 && share <= 1)
                    borders_.insert(t.from.u + other_share * other.u);
            }
    }

    /// Face that crosses a slab; it contains the places with u in the middle of the slab and v between the two numbers.
    struct ActiveFace {
        Rational low, high;
        std::size_t index;
    };

    static std::vector<ActiveFace> active_faces(const std::vector<ShearedFace>& faces, const Rational& u) {
        std::vector<ActiveFace> active;
        for (std::size_t f = 0; f < faces.size(); ++f) {
            std::vector<Rational> crossings;
            for (std::size_t k = 0; k < 3; ++k) {
                const ShearedPlace p = faces[f].place(k), edge = faces[f].edge(k);
                if ((p.u < u) != (p.u + edge.u < u)) crossings.push_back(p.v + (u - p.u) / edge.u * edge.v);
            }
            if (crossings.size() != 2) continue;
            std::sort(crossings.begin(), crossings.end());
            active.push_back({crossings[0], crossings[1], f});
        }
        return active;
    }

    // No segments cross between the two borders, and none ends.
    void sweep_slab(const Rational& low, const Rational& high) {
        cancellation_.check();
        const Rational middle = (low + high) / 2;
        const std::vector<ActiveFace> a = active_faces(faces_[0], middle), b = active_faces(faces_[1], middle);
        if (a.empty() || b.empty()) return;
        std::vector<std::pair<Rational, const PlaneSegment*>> active;  // v at the middle
        for (const PlaneSegment& s : segments_)
            if (s.from.u <= low && s.to.u >= high) active.emplace_back(s.v_at(middle), &s);
        std::sort(active.begin(), active.end());
        for (std::size_t i = 0; i + 1 < active.size(); ++i) {
            if (active[i].first == active[i + 1].first) continue;
            const PlaneSegment &below = *active[i].second, &above = *active[i + 1].second;
            const Corners corners{ShearedPlace{low, below.v_at(low)}, ShearedPlace{low, above.v_at(low)},
                                  ShearedPlace{high, below.v_at(high)}, ShearedPlace{high, above.v_at(high)}};
            const ShearedPlace inner{middle, (active[i].first + active[i + 1].first) / 2};
            const std::vector<FaceInterval> of_b = insides(faces_[1], b, inner);
            if (!of_b.empty()) add_intervals(insides(faces_[0], a, inner), of_b, corners);
        }
    }

    static std::vector<FaceInterval> insides(const std::vector<ShearedFace>& faces,
                                             const std::vector<ActiveFace>& active, const ShearedPlace& p) {
        std::vector<std::pair<Rational, std::size_t>> crossed;
        for (const ActiveFace& face : active)
            if (face.low < p.v && p.v < face.high) crossed.emplace_back(faces[face.index].height(p), face.index);
        std::sort(crossed.begin(), crossed.end());
        std::vector<FaceInterval> intervals;
        int winding = 0;
        for (std::size_t i = 0; i < crossed.size(); ++i) {
            if (winding != 0) intervals.back().top = crossed[i].second;
            const bool was_inside = winding != 0;
            // Faces that are equally high at p coincide in the whole trapezoid.
            winding += faces[crossed[i].second].jump();
            while (i + 1 < crossed.size() && crossed[i + 1].first == crossed[i].first)
                winding += faces[crossed[++i].second].jump();
            if (winding != 0 && !was_inside) intervals.push_back({crossed[i].second, crossed[i].second});
        }
        return intervals;
    }

    void add_intervals(const std::vector<FaceInterval>& a, const std::vector<FaceInterval>& b, const Corners& corners) {
        for (const FaceInterval& x : a)
            for (const FaceInterval& y : b) {
                OpenInterval t;
                for (std::size_t k = 0; k < 4; ++k) {
                    const ShearedPlace& p = corners[k];
                    const Rational low = faces_[0][x.bottom].height(p) - faces_[1][y.top].height(p),
                                   high = faces_[0][x.top].height(p) - faces_[1][y.bottom].height(p);
                    if (k == 0 || low < t.low) t.low = low;
                    if (k == 0 || high > t.high) t.high = high;
                }
                if (t.high > 0) intervals_.push_back(t);
            }
    }

    Cancellation& cancellation_;
    std::array<std::vector<ShearedFace>, 2> faces_;
    std::vector<PlaneSegment> segments_;
    std::set<Rational> borders_;
    std::vector<OpenInterval> intervals_;
};

/// Returns the least number of at least 0 that is in none of the intervals.
Rational least_outside(std::vector<OpenInterval> intervals) {
    std::sort(intervals.begin(), intervals.end(),
              [](const OpenInterval& x, const OpenInterval& y) { return x.low < y.low; });
    Rational least = 0;
    for (const OpenInterval& interval : intervals) {
        if (interval.low >= least) break;
        if (interval.high > least) least = interval.high;
    }
    return least;
}

}  // namespace

double first_free_by_brute_force(const PosedBody& a, const PosedBody& b, const Vec3d& direction,
                                 Cancellation& cancellation) {
    std::vector<Vec3d> points = a.point;
    points.insert(points.end(), b.point.begin(), b.point.end());
    const int axis = direction.x != 0 ? 0 : direction.y != 0 ? 1 : 2;
    const Shear shear(direction, axis, common_exponent(points));
    return rounded_up(shear.parameter_of(least_outside(OverlapIntervals(a, b, shear, cancellation).find())));
}

}  // namespace crumple
