// One file, because all parts of a row are sums over the same crossings, which one class finds.

#include "backends/reference/reference_overlaps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "backends/reference/reference_bodies.h"
#include "backends/reference/reference_first_free.h"
#include "exact/distance/nearest_triangle.h"
#include "exact/intersection/exact_intersection.h"
#include "exact/overlap/exact_crossing.h"
#include "exact/overlap/overlap_totals.h"
#include "exact/overlap/pair_terms.h"
#include "exact/overlap/rational_sum.h"
#include "exact/withdrawal/exact_withdrawal.h"
#include "results/joined_curves.h"
#include "results/overlap_output.h"
#include "results/overlap_regions.h"
#include "results/withdrawal_output.h"
#include "scene/orientation.h"

namespace crumple {
namespace {

Vec3<Rational> rational(const Vec3d& p) { return {Rational(p.x), Rational(p.y), Rational(p.z)}; }

/// Returns twice the area vector of the intersection of two faces; 0 unless they are coplanar.
Vec3<Rational> common_area_vector(const std::array<Vec3d, 3>& a, const std::array<Vec3d, 3>& b) {
    const std::array q{rational(b[0]), rational(b[1]), rational(b[2])};
    const Vec3<Rational> normal = cross(q[1] - q[0], q[2] - q[0]);
    if (normal == Vec3<Rational>{}) return {};
    std::vector<Vec3<Rational>> polygon{rational(a[0]), rational(a[1]), rational(a[2])};
    for (const auto& p : polygon)
        if (dot(normal, p - q[0]) != 0) return {};
    for (std::size_t i = 0; i < 3; ++i) {  // clips to the inner side of each edge of b
        std::vector<Vec3<Rational>> left;
        const auto side = [&](const Vec3<Rational>& p) { return dot(normal, cross(q[(i + 1) % 3] - q[i], p - q[i])); };
        for (std::size_t k = 0; k < polygon.size(); ++k) {
            const Vec3<Rational>&from = polygon[k], &to = polygon[(k + 1) % polygon.size()];
            const Rational start = side(from), end = side(to);
            if (start >= 0) left.push_back(from);
            if ((start > 0 && end < 0) || (start < 0 && end > 0)) {
                const Rational share = start / (start - end);
                left.push_back(from + share * (to - from));
            }
        }
        polygon = std::move(left);
    }
    Vec3<Rational> area{};
    for (std::size_t k = 2; k < polygon.size(); ++k)
        area = area + cross(polygon[k - 1] - polygon[0], polygon[k] - polygon[0]);
    return area;
}

/// Corners of a face relative to the origin of the sums, and a normal whose length is twice the face's area.
struct PlacedFace {
    std::array<Vec3<Rational>, 3> corner;
    Vec3<Rational> normal;

    Rational cone() const { return dot(normal, corner[0]); }
};

PlacedFace placed(const std::array<Vec3d, 3>& p, const Vec3d& origin) {
    const auto from = [&](const Vec3d& q) {
        return Vec3<Rational>{Rational(q.x) - Rational(origin.x), Rational(q.y) - Rational(origin.y),
                              Rational(q.z) - Rational(origin.z)};
    };
    PlacedFace face{{from(p[0]), from(p[1]), from(p[2])}, {}};
    face.normal = cross(face.corner[1] - face.corner[0], face.corner[2] - face.corner[0]);
    return face;
}

/// Sums over segments, in the form that finish_curves() needs.
struct CurveSums {
    CurveTotals<RationalSum> totals;
    Cancellation& cancellation;

    /// Adds a segment of the forward shift; its ends are relative to the origin.
    void add_curve(const Vec3<Rational>& start, const Vec3<Rational>& end) {
        CurveTerms<Rational> terms;
        terms.add(start, end);
        for (int axis = 0; axis < 3; ++axis) {
            totals.area[static_cast<std::size_t>(axis)].add(2 * terms.area[axis]);
            totals.torque[static_cast<std::size_t>(axis)].add(2 * terms.torque[axis]);
        }
    }

    template <class Combine>
    RoundedSum curves(Combine combine, int divisor) const {
        return combine(totals).rounded_quotient(divisor, cancellation);
    }
};

/// Segment in which two faces cross, with its ends. Or a link: the crossing of two faces at least one of which is
/// degenerate. A link has no length and no ends; it connects segments to a curve (results/joined_curves.h).
struct PlacedSegment {
    Segment segment;
    bool is_link = false;
    Vec3<Rational> start, end;
};

PlacedSegment placed(const RationalCrossing& crossing, std::size_t f, std::size_t g, const std::array<Vec3d, 3>& p) {
    PlacedSegment placed;
    placed.segment = segment_of(crossing.jumps, [](std::size_t, std::size_t) { return -1; });
    placed.segment.a = static_cast<std::int32_t>(f);
    placed.segment.b = static_cast<std::int32_t>(g);
    placed.is_link = !crossing.jumps.segment;
    if (placed.is_link) return placed;
    const auto at = [&](const PointInFace<Rational>& x) {
        const Vec3<Rational> q = rational(p[0]);
        return q + x.u * (rational(p[1]) - q) + x.v * (rational(p[2]) - q);
    };
    placed.start = at(crossing.start_in_a);
    placed.end = at(crossing.end_in_a);
    return placed;
}

class BruteForceOverlap {
   public:
    /// `self`: 0 for two bodies; for the overlap of a body with itself, its orientation, 1 or -1. `orientation`: that
    /// of both bodies.
    BruteForceOverlap(const PosedBody& a, const PosedBody& b, int self, const std::array<int, 2>& orientation,
                      Cancellation& cancellation)
        : a_(a), b_(b), self_(self), orientation_(orientation), cancellation_(cancellation) {
        std::vector<Vec3d> points = a.point;
        points.insert(points.end(), b.point.begin(), b.point.end());
        exponent_ = common_exponent(points);
        for (int axis = 0; axis < 3; ++axis) {
            origin_[axis] = 0.5 * max(a.box.low[axis], b.box.low[axis]) + 0.5 * min(a.box.high[axis], b.box.high[axis]);
            if (!(std::abs(origin_[axis]) >= 0x1p-150)) origin_[axis] = 0;
        }
    }

    /// Returns the row of two surfaces of which at least one is not closed: only the contact area, the torque point
    /// (the origin of the sums) and the curves are defined.
    OverlapRow open_row() {
        OverlapRow row;
        add(Shift::forward, row);
        row.exists = meet_;
        row.relation = OverlapRelation::undefined;
        row.windings = {};
        row.numbers = undefined_numbers(origin_);
        row.numbers.contact_area = contact_area_.rounded_quotient(2, cancellation_).value;
        sort_segments();
        row.curves = curves(origin_);
        return row;
    }

    OverlapRow row() {
        OverlapRow row;
        for (const Shift shift : {Shift::forward, Shift::backward}) add(shift, row);
        row.body_volume = self_ * rounded(six_volumes_of(a_), 6) + 0.0;
        row.exists = meet_ || enclosed_;
        if (!row.exists) return row;
        row.numbers = finish(*this, origin_, self_ != 0);
        row.numbers.contact_area = contact_area_.rounded_quotient(2, cancellation_).value;
        if (self_ != 0) row.exists = row.numbers.volume.scaled.mantissa != 0;
        row.relation = self_ != 0 ? OverlapRelation::overlapping : relation();
        for (std::size_t side = 0; side < 2; ++side) row.gradient[side] = gradient(side);
        if (self_ != 0) return row;
        std::vector<std::int32_t> region_of_segment;
        add_regions(row, region_of_segment);
        row.curves = curves(row.numbers.point);
        add_unions(row);
        row.depths = {depths(a_, b_, row.windings[0]), depths(b_, a_, row.windings[1])};
        for (std::size_t i = 0; i < row.curves.size(); ++i) row.curves[i].region = region_of_segment[first_segment_[i]];
        return row;
    }

    // Sums that finish() needs.
    template <class Combine>
    RoundedSum volume(Combine combine, int divisor) const {
        return combine(volume_totals_).rounded_quotient(divisor, cancellation_);
    }
    template <class Combine>
    RoundedSum curves(Combine combine, int divisor) const {
        return combine(curve_totals_).rounded_quotient(divisor, cancellation_);
    }

   private:
    using Weights = std::vector<FaceWeights<Rational>>;

    /// Returns the weights of the faces of `of` before crossings are added: all three are the winding number of `other`
    /// at the face's first corner. Sets `enclosed` if that number is not 0 for some face.
    Weights uncrossed(const PosedBody& of, const PosedBody& other, Shift shift, bool& enclosed) {
        Weights weights(of.face.size());
        for (std::size_t f = 0; f < of.face.size(); ++f) {
            cancellation_.check();
            const Vec3d p = of.corners(f)[0];
            int winding = 0;
            for (std::size_t g = 0; g < other.face.size(); ++g)
                winding += winding_along_ray(in_units(p, exponent_), in_units(other.corners(g), exponent_), shift);
            weights[f].fill(Rational(winding));
            const std::int32_t vertex = of.name[static_cast<std::size_t>(of.face[f][0])];
            enclosed |= winding != 0 && of.used.contains(vertex);  // a vertex without an edge does not count
        }
        return weights;
    }

    void add(Shift shift, OverlapRow& row) {
        const bool forward = shift == Shift::forward;
        bool enclosed = false;
        Weights on_a = uncrossed(a_, b_, shift, enclosed), on_b = uncrossed(b_, a_, opposite(shift), enclosed);
        if (forward) {
            enclosed_ = enclosed;
            row.windings = {windings(a_, b_, shift), windings(b_, a_, opposite(shift))};
            if (self_ != 0) row.windings[1].clear();
        }
        for (std::size_t f = 0; f < a_.face.size(); ++f)
            for (std::size_t g = 0; g < b_.face.size(); ++g) {
                cancellation_.check();
                if (self_ != 0 && f == g) continue;
                const auto p = a_.corners(f), q = b_.corners(g);
                if (!boxes_meet(p, q)) continue;
                meet_ = meet_ || triangles_meet(p, q);
                if (forward && (self_ == 0 || f < g)) add_contact_area(common_area_vector(p, q));
                const RationalCrossing crossing =
                    cross_rationally(in_units(p, exponent_), in_units(q, exponent_), shift);
                const auto crosses = [](int jump) { return jump != 0; };
                if (forward && (std::any_of(crossing.jumps.a.begin(), crossing.jumps.a.end(), crosses) ||
                                std::any_of(crossing.jumps.b.begin(), crossing.jumps.b.end(), crosses)))
                    segments_.push_back(placed(crossing, f, g, p));
                for (std::size_t k = 0; k < 3; ++k) {
                    on_a[f][k] += crossing.a[k];
                    on_b[g][k] += crossing.b[k];
                }
            }
        for (std::size_t f = 0; f < a_.face.size(); ++f) {
            const PlacedFace face = placed(a_.corners(f), origin_);
            if (forward) add_volume(face, on_a[f]);
            const auto& w = on_a[f];
            const Vec3<Rational> at = w[0] * face.corner[0] + w[1] * face.corner[1] + w[2] * face.corner[2];
            const Vec3<Rational> torque = cross(face.normal, at);
            for (std::size_t k = 0; k < 3; ++k) {
                curve_totals_.area[k].add((w[0] + w[1] + w[2]) * face.normal[static_cast<int>(k)] / 3);
                curve_totals_.torque[k].add(torque[static_cast<int>(k)]);
            }
        }
        for (std::size_t g = 0; g < b_.face.size() && forward; ++g) add_volume(placed(b_.corners(g), origin_), on_b[g]);
        add_gradient(a_, on_a, gradient_[0]);
        add_gradient(b_, on_b, gradient_[self_ != 0 ? 0 : 1]);
        if (self_ == 0) return;
        const FaceWeights<Rational> one{-self_, -self_, -self_};
        for (std::size_t f = 0; f < a_.face.size() && forward; ++f) add_volume(placed(a_.corners(f), origin_), one);
        add_gradient(a_, Weights(a_.face.size(), one), gradient_[0]);
    }

    void add_contact_area(const Vec3<Rational>& twice) {
        if (const Rational square = dot(twice, twice); square != 0)
            contact_area_.times_root_of(square).add(Rational(1));
    }

    /// Puts links last, and lists the segments without their ends.
    void sort_segments() {
        std::stable_partition(segments_.begin(), segments_.end(), [](const auto& s) { return !s.is_link; });
        for (const PlacedSegment& placed : segments_) {
            joints_.push_back(placed.segment);
            if (!placed.is_link) ++links_;
        }
    }
    FaceReader face_reader() const {
        return [this](std::size_t side, std::int32_t f) {
            const PosedBody& body = side == 0 ? a_ : b_;
            FaceOfSurface of{body.face[static_cast<std::size_t>(f)], body.corners(static_cast<std::size_t>(f))};
            for (std::int32_t& vertex : of.vertex) vertex = body.name[static_cast<std::size_t>(vertex)];
            return of;
        };
    }

    std::vector<OverlapCurve> curves(const Vec3d& point) {
        std::vector<OverlapCurve> curves;
        for (const JoinedCurve& joined : join_segments(joints_, links_, face_reader())) {
            curves.push_back(curve_of(joined, point));
            first_segment_.push_back(static_cast<std::size_t>(joined.segments[0]));
        }
        return curves;
    }

    void add_unions(OverlapRow& row) const {
        const Rational a = orientation_[0] * six_volumes_of(a_), b = orientation_[1] * six_volumes_of(b_),
                       both = orientation_[0] * orientation_[1] * six_volumes_, all = a + b - both;
        row.unions.volume = rounded(all, 6);
        if (all != 0)
            row.unions.share = 0.0 + orientation_[0] * orientation_[1] *
                                         (row.numbers.volume.scaled / rounded_sum(all, 6).scaled).value();
        row.unions.difference = {rounded(a - both, 6), rounded(b - both, 6)};
    }

    std::vector<VertexDepth> depths(const PosedBody& of, const PosedBody& other,
                                    const std::vector<VertexWinding>& inside) const {
        std::vector<NearTriangle> triangles;
        for (std::size_t g = 0; g < other.face.size(); ++g)
            triangles.push_back({static_cast<std::int32_t>(g), other.corners(g)});
        std::vector<VertexDepth> depths;
        std::int64_t rational = 0;
        for (const VertexWinding& vertex : inside) {
            const Vec3d& p = of.point[static_cast<std::size_t>(vertex.vertex)];
            if (const auto nearest = decide_nearest(p, triangles, 0, false, cancellation_, rational))
                depths.push_back({vertex.vertex, nearest->distance, nearest->point, nearest->triangle});
        }
        return depths;
    }

    /// Adds the regions to the row, and the extents of the row and of the regions.
    void add_regions(OverlapRow& row, std::vector<std::int32_t>& region_of_segment) {
        sort_segments();
        std::array<std::vector<std::int32_t>, 2> faces;
        RegionInput input{.segments = joints_, .links = links_, .face = face_reader(), .in_range = false};
        std::array<std::vector<std::int32_t>, 2> corners;
        for (std::size_t side = 0; side < 2; ++side) {
            const PosedBody& body = side == 0 ? a_ : b_;
            for (std::size_t f = 0; f < body.face.size(); ++f) faces[side].push_back(static_cast<std::int32_t>(f));
            for (const auto& face : body.face)
                for (const std::int32_t v : face) corners[side].push_back(body.name[static_cast<std::size_t>(v)]);
            input.corners[side] = corners[side].data();
            input.inside[side] = row.windings[side];
            input.faces[side] = faces[side];
            input.vertex_count[side] = body.point.size();
            input.face_count[side] = body.face.size();
        }
        RegionParts all;
        all.inside = row.windings;
        for (std::size_t s = 0; s < links_; ++s) all.segments.push_back(static_cast<std::int32_t>(s));
        row.extent = extent(all, row.numbers.normal);
        region_of_segment.assign(links_, -1);
        for (const RegionParts& parts : find_regions(input, cancellation_)) {
            for (const std::int32_t s : parts.segments)
                region_of_segment[static_cast<std::size_t>(s)] = static_cast<std::int32_t>(row.regions.size());
            OverlapRegion& region = row.regions.emplace_back();
            RegionSums sums(*this, parts);
            region.numbers = finish(sums, origin_, false);
            region.extent = extent(parts, region.numbers.normal);
            region.merged = parts.merged;
            region.pieces = parts.pieces;
        }
    }

    /// Sums over the cones that a region adds, in the form that finish() needs.
    struct RegionSums : CurveSums {
        VolumeTotals<RationalSum> volumes;

        RegionSums(const BruteForceOverlap& of, const RegionParts& parts) : CurveSums{{}, of.cancellation_} {
            const Vec3<Rational> origin = rational(of.origin_);
            const auto add_cone = [&](const Vec3<Rational>& x, const Vec3<Rational>& y, const Vec3<Rational>& z,
                                      int w) {
                const Rational cone = w * dot(x, cross(y, z));
                const Vec3<Rational> moment = cone * (x + y + z);
                volumes.volume.add(cone);
                for (std::size_t k = 0; k < 3; ++k) volumes.moment[k].add(moment[static_cast<int>(k)]);
            };
            const auto corner = [&](std::size_t side, std::int32_t f, std::size_t k) {
                const PosedBody& body = side == 0 ? of.a_ : of.b_;
                return rational(body.corners(static_cast<std::size_t>(f))[k]) - origin;
            };
            const auto add_face = [&](std::size_t side, std::int32_t f, int w) {
                add_cone(corner(side, f, 0), corner(side, f, 1), corner(side, f, 2), w);
            };
            for (const std::int32_t s : parts.segments) {
                const PlacedSegment& placed = of.segments_[static_cast<std::size_t>(s)];
                const Segment& segment = placed.segment;
                const Vec3<Rational> start = placed.start - origin, end = placed.end - origin;
                add_cone(corner(0, segment.a, 0), start, end, 1);
                add_cone(corner(1, segment.b, 0), end, start, 1);
                for (const bool at_start : {true, false}) {
                    const SegmentEnd& on = at_start ? segment.start : segment.end;
                    const std::int32_t f = on.side == 0 ? segment.a : segment.b;
                    if (on.edge == 0) add_face(on.side, f, on.jump);
                    if (on.edge == 1)
                        add_cone(corner(on.side, f, 0), at_start ? start : end, corner(on.side, f, 2), on.jump);
                }
                add_curve(start, end);
            }
            for (std::size_t side = 0; side < 2; ++side) {
                const PosedBody& body = side == 0 ? of.a_ : of.b_;
                std::map<std::int32_t, int> winding;
                for (const VertexWinding& vertex : parts.inside[side]) winding[vertex.vertex] = vertex.winding;
                for (std::size_t f = 0; f < body.face.size(); ++f) {
                    const auto w = winding.find(body.name[static_cast<std::size_t>(body.face[f][0])]);
                    if (w != winding.end()) add_face(side, static_cast<std::int32_t>(f), w->second);
                }
            }
        }
        template <class Combine>
        RoundedSum volume(Combine combine, int divisor) const {
            return combine(volumes).rounded_quotient(divisor, cancellation);
        }
    };

    OverlapExtent extent(const RegionParts& parts, const Vec3d& normal) const {
        std::vector<Vec3<Rational>> points;
        for (std::size_t side = 0; side < 2; ++side)
            for (const VertexWinding& vertex : parts.inside[side])
                points.push_back(rational((side == 0 ? a_ : b_).point[static_cast<std::size_t>(vertex.vertex)]));
        for (const std::int32_t s : parts.segments) {
            points.push_back(segments_[static_cast<std::size_t>(s)].start);
            points.push_back(segments_[static_cast<std::size_t>(s)].end);
        }
        OverlapExtent extent = no_extent;
        if (points.empty()) return extent;
        const auto range = [&](const Vec3<Rational>& along) {
            Rational low = dot(along, points[0]), high = low;
            for (const auto& p : points) {
                const Rational x = dot(along, p);
                if (x < low) low = x;
                if (x > high) high = x;
            }
            return std::pair(low, high);
        };
        constexpr double infinity = std::numeric_limits<double>::infinity();
        for (int axis = 0; axis < 3; ++axis) {
            Vec3<Rational> along;
            along[axis] = 1;
            const std::pair<Rational, Rational> x = range(along);
            const double low = rounded(x.first, 1), high = rounded(x.second, 1);
            extent.low[axis] = Rational(low) > x.first ? std::nextafter(low, -infinity) : low;
            extent.high[axis] = Rational(high) < x.second ? std::nextafter(high, infinity) : high;
        }
        if (!all_finite(normal)) return extent;
        const std::pair<Rational, Rational> x = range(rational(normal));
        extent.thickness = rounded(x.second - x.first, 1);
        return extent;
    }

    OverlapCurve curve_of(const JoinedCurve& joined, const Vec3d& point) {
        OverlapCurve curve;
        curve.closed = joined.closed;
        CurveSums sums{{}, cancellation_};
        const auto add_point = [&](const Vec3<Rational>& p) {
            curve.points.push_back({rounded(p.x, 1), rounded(p.y, 1), rounded(p.z, 1)});
        };
        for (const std::int32_t s : joined.segments) {
            const PlacedSegment& placed = segments_[static_cast<std::size_t>(s)];
            add_point(placed.start);
            curve.triangles.push_back({placed.segment.a, placed.segment.b});
            const Vec3<Rational> origin = rational(origin_);
            sums.add_curve(placed.start - origin, placed.end - origin);
        }
        add_point(segments_[static_cast<std::size_t>(joined.segments.back())].end);
        constexpr double nan = std::numeric_limits<double>::quiet_NaN();
        curve.area_vector = curve.torque = {nan, nan, nan};
        if (!curve.closed) return curve;
        const CurveNumbers numbers = finish_curves(sums, origin_, point);
        curve.area_vector = CurveNumbers::values(numbers.area);
        curve.torque = CurveNumbers::values(numbers.torque);
        return curve;
    }

    using Gradient = std::map<std::int32_t, std::array<RationalSum, 3>>;

    void add_gradient(const PosedBody& body, const Weights& weights, Gradient& gradient) {
        for (std::size_t f = 0; f < body.face.size(); ++f) {
            const Vec3<Rational> normal = placed(body.corners(f), origin_).normal;
            for (std::size_t k = 0; k < 3; ++k)
                for (int axis = 0; axis < 3; ++axis)
                    gradient[body.name[static_cast<std::size_t>(body.face[f][k])]][static_cast<std::size_t>(axis)].add(
                        weights[f][k] * normal[axis]);
        }
    }

    std::vector<VertexVector> gradient(std::size_t side) const {
        std::vector<VertexVector> rows;
        for (const auto& [vertex, sums] : gradient_[side]) {
            VertexVector row{vertex, {}};
            bool zero = true;
            for (int axis = 0; axis < 3; ++axis) {
                const RoundedSum sum =
                    sums[static_cast<std::size_t>(axis)].rounded_quotient(self_ != 0 ? 24 : 12, cancellation_);
                row.value[axis] = sum.value;
                zero = zero && sum.scaled.mantissa == 0;
            }
            if (!zero) rows.push_back(row);
        }
        return rows;
    }

    std::vector<VertexWinding> windings(const PosedBody& of, const PosedBody& other, Shift shift) const {
        std::vector<VertexWinding> rows;
        for (const std::int32_t vertex : of.used) {
            int winding = 0;
            for (std::size_t g = 0; g < other.face.size(); ++g)
                winding += winding_along_ray(of.point[static_cast<std::size_t>(vertex)], other.corners(g), shift);
            if (winding != 0) rows.push_back({vertex, winding});
        }
        return rows;
    }

    static RoundedSum rounded_sum(const Rational& x, int divisor) {
        Cancellation none;
        RationalSum sum;
        sum.add(x);
        return sum.rounded_quotient(divisor, none);
    }
    static double rounded(const Rational& x, int divisor) { return rounded_sum(x, divisor).value; }
    Rational six_volumes_of(const PosedBody& body) const {
        Rational six = 0;
        for (std::size_t f = 0; f < body.face.size(); ++f) six += placed(body.corners(f), origin_).cone();
        return six;
    }

    void add_volume(const PlacedFace& face, const FaceWeights<Rational>& w) {
        const Rational cone = face.cone(), six = cone * (w[0] + w[1] + w[2]) / 3;
        const Vec3<Rational> moment = cone * (w[0] * face.corner[0] + w[1] * face.corner[1] + w[2] * face.corner[2]);
        six_volumes_ += six;
        volume_totals_.volume.add(six);
        for (std::size_t k = 0; k < 3; ++k) volume_totals_.moment[k].add(moment[static_cast<int>(k)]);
    }

    static bool boxes_meet(const std::array<Vec3d, 3>& p, const std::array<Vec3d, 3>& q) {
        Bounds one = no_bounds, other = no_bounds;
        for (std::size_t k = 0; k < 3; ++k) one.widen(p[k]), other.widen(q[k]);
        return overlap(one, other);
    }
    static bool triangles_meet(const std::array<Vec3d, 3>& p, const std::array<Vec3d, 3>& q) {
        return intersect_rationally({p, {0, 1, 2}}, {q, {3, 4, 5}}).collides;
    }

    OverlapRelation relation() const {
        if (six_volumes_ == 0) return meet_ ? OverlapRelation::touching : OverlapRelation::overlapping;
        const auto has_that_volume = [&](const PosedBody& body) {
            return abs(six_volumes_) == abs(six_volumes_of(body));
        };
        const bool first = has_that_volume(a_), second = has_that_volume(b_);
        if (first && second) return OverlapRelation::equal;
        if (first) return OverlapRelation::first_inside;
        return second ? OverlapRelation::second_inside : OverlapRelation::overlapping;
    }

    const PosedBody &a_, &b_;
    int self_;
    std::array<int, 2> orientation_;
    Cancellation& cancellation_;
    int exponent_ = 0;
    Vec3d origin_;
    bool meet_ = false, enclosed_ = false;
    Rational six_volumes_ = 0;  ///< 6 times the volume of the overlap
    VolumeTotals<RationalSum> volume_totals_;
    CurveTotals<RationalSum> curve_totals_;
    RootSum contact_area_;
    std::vector<PlacedSegment> segments_;
    std::vector<Segment> joints_;             ///< segments_ without their ends; links are last
    std::size_t links_ = 0;                   ///< index of the first link
    std::vector<std::size_t> first_segment_;  ///< by curve
    std::array<Gradient, 2> gradient_;
};

/// Adds the withdrawals of all pairs of faces, decided in rationals.
void add_withdrawals(const OverlapQuery& query, const PosedBody& a, const PosedBody& b, OverlapRow& row) {
    const auto withdraw = [&](const Vec3d& direction) {
        Rational greatest = 0;
        for (std::size_t f = 0; f < a.face.size(); ++f)
            for (std::size_t g = 0; g < b.face.size(); ++g)
                if (const auto t = withdrawal_rationally(a.corners(f), b.corners(g), direction); t && *t > greatest)
                    greatest = *t;
        return rounded_up(greatest);
    };
    const auto projected_area = [&](int side) {
        const PosedBody& body = side == 0 ? a : b;
        ProjectedArea area;
        for (std::size_t f = 0; f < body.face.size(); ++f) area.add(body.corners(f));
        return area.bound();
    };
    add_withdrawals(query, withdraw, projected_area, row);
}

void add_first_free(const OverlapQuery& query, const PosedBody& a, const PosedBody& b, Cancellation& cancellation,
                    OverlapRow& row) {
    for (const auto& [x, y, z] : query.directions)
        row.first_free.push_back(first_free_by_brute_force(a, b, {x, y, z}, cancellation));
}

}  // namespace

void find_overlaps_by_brute_force(const World& world, const OverlapQuery& query, MemoryMeter& meter,
                                  Cancellation& cancellation, Overlaps& result) {
    const PosedBodies bodies(world, query.filter, query.weld, meter);
    const WorldOutline& outline = bodies.outline();
    begin(query, outline.worlds(), outline.bodies(), result);
    result.statistics.backend = "reference";
    result.statistics.simd = "scalar";
    result.statistics.triangles = outline.triangles();
    std::vector<std::int32_t> skipped;
    std::set<std::int32_t> solids;
    std::vector<std::pair<BodyPair, OverlapRow>> rows;
    for (const auto& [a, b] : bodies.near_pairs(query.self_overlaps)) {
        const std::vector<std::int32_t> open = bodies.open_bodies({a, b}, query.open, "OverlapQuery");
        if (query.open == OpenSurfaces::skip) skipped.insert(skipped.end(), open.begin(), open.end());
        if (!open.empty() && (a == b || query.open == OpenSurfaces::skip)) continue;
        const auto orientation = [&](std::int32_t body) {
            return orientation_of(outline.placement(body)) < 0 ? -1 : 1;
        };
        BruteForceOverlap overlap(bodies[a], bodies[b], a == b ? orientation(a) : 0, {orientation(a), orientation(b)},
                                  cancellation);
        OverlapRow row = open.empty() ? overlap.row() : overlap.open_row();
        if (a == b) add_body(a, row, result);
        if (a != b && row.exists) add_withdrawals(query, bodies[a], bodies[b], row);
        if (a != b && row.exists && query.first_free && open.empty())
            add_first_free(query, bodies[a], bodies[b], cancellation, row);
        if (a == b && is_solid(row)) solids.insert(a);
        orient(orientation(a), orientation(b), row);
        if (!query.gradient) row.gradient = {};
        if (!query.windings) row.windings = {};
        if (!query.regions) row.regions = {};
        if (!query.depths) row.depths = {};
        if (is_in_result(query, row)) rows.emplace_back(BodyPair{a, b}, std::move(row));
    }
    for (const auto& [pair, row] : rows) {
        const bool proved = solids.contains(pair.first) && solids.contains(pair.second);
        const bool both = query.self_overlaps ? proved : query.solids;
        add_row(query, pair, outline.body(pair.first).world, row, both, result);
    }
    add_skipped(std::move(skipped), result);
    result.count = static_cast<std::int64_t>(result.bodies.size());
}

}  // namespace crumple
