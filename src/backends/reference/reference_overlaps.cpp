#include "backends/reference/reference_overlaps.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "exact/intersection/rational_intersection.h"
#include "exact/overlap/overlap_totals.h"
#include "exact/overlap/rational_crossing.h"
#include "exact/overlap/rational_sum.h"
#include "results/overlap_output.h"
#include "scene/body_rules.h"
#include "scene/open_surface.h"
#include "scene/orientation.h"
#include "scene/world_outline.h"
#include "scene/world_scene.h"

namespace crumple {
namespace {

/// A body where it is.
struct PosedBody {
    std::vector<Vec3d> point;
    std::vector<std::array<std::int32_t, 3>> face;
    std::vector<std::int32_t> name;  ///< by vertex: the lowest vertex that it is one with
    std::set<std::int32_t> used;     ///< names of vertices at which there is an edge
    std::map<Edge, OpenEdge> open;
    Bounds box = no_bounds;

    std::array<Vec3d, 3> corners(std::size_t f) const {
        const auto at = [&](std::size_t k) { return point[static_cast<std::size_t>(face[f][k])]; };
        return {at(0), at(1), at(2)};
    }
};

void find_open_edges(const std::vector<Vec3d>& given, bool weld, PosedBody& body) {
    std::map<std::tuple<double, double, double>, std::int32_t> first_at;
    auto& name = body.name;
    for (std::size_t v = 0; v < given.size(); ++v) {
        const auto at = std::tuple(given[v].x + 0.0, given[v].y + 0.0, given[v].z + 0.0);  // -0 + 0 is +0
        const auto own = static_cast<std::int32_t>(v);
        name.push_back(weld ? first_at.try_emplace(at, own).first->second : own);
    }
    std::map<Edge, int> directions;
    for (std::size_t t = 0; t < body.face.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const auto v = [&](std::size_t corner) { return name[static_cast<std::size_t>(body.face[t][corner])]; };
            const std::int32_t a = v(k), b = v((k + 1) % 3);
            if (a == b) continue;
            body.used.insert({a, b});
            const Edge edge{std::min(a, b), std::max(a, b)};
            directions[edge] += a < b ? 1 : -1;
            body.open.try_emplace(edge, OpenEdge{edge, static_cast<std::int32_t>(t)});
        }
    for (const auto& [edge, sum] : directions)
        if (sum == 0) body.open.erase(edge);
}

PosedBody posed_body(const WorldOutline& outline, std::int32_t b, bool weld) {
    const Shape& shape = outline.shape(b);
    const VertexReader position = reader_of(shape);
    const Placement place = outline.placement(b);
    PosedBody body;
    std::vector<Vec3d> given;
    for (std::int64_t v = 0; v < shape.vertices.rows; ++v) {
        given.push_back(position(v));
        body.point.push_back(place(given.back()));
        if (!all_finite(body.point.back())) fail_body_not_finite(outline, b);
        body.box.widen(body.point.back());
    }
    with_corner_reader(shape, [&](auto corner) {
        for (std::int64_t t = 0; t < shape.triangles.rows; ++t) {
            std::array<std::int32_t, 3>& face = body.face.emplace_back();
            for (std::size_t k = 0; k < 3; ++k) {
                const std::int64_t v = corner(t, static_cast<int>(k));
                if (v < 0 || v >= shape.vertices.rows) fail_index(WorldOutline::name(b), t, v, shape.vertices.rows);
                face[k] = static_cast<std::int32_t>(v);
            }
        }
    });
    if (body.face.empty()) body.box = no_bounds;  // its vertices are nothing
    find_open_edges(given, weld, body);
    return body;
}

IntegerTriangle in_units(const std::array<Vec3d, 3>& p, int exponent) {
    return {scaled(p[0], exponent), scaled(p[1], exponent), scaled(p[2], exponent)};
}

/// Corners of a face from the origin, and its normal.
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

class BruteForceOverlap {
   public:
    /// `self`: 0, or the orientation of a body that is both a and b.
    BruteForceOverlap(const PosedBody& a, const PosedBody& b, int self, Cancellation& cancellation)
        : a_(a), b_(b), self_(self), cancellation_(cancellation) {
        std::vector<Vec3d> points = a.point;
        points.insert(points.end(), b.point.begin(), b.point.end());
        exponent_ = common_exponent(points);
        for (int axis = 0; axis < 3; ++axis) {
            origin_[axis] = 0.5 * max(a.box.low[axis], b.box.low[axis]) + 0.5 * min(a.box.high[axis], b.box.high[axis]);
            if (!(std::abs(origin_[axis]) >= 0x1p-150)) origin_[axis] = 0;
        }
    }

    OverlapRow row() {
        OverlapRow row;
        for (const Shift shift : {Shift::forward, Shift::backward}) add(shift, row);
        row.body_volume = self_ * rounded(six_volumes_of(a_), 6) + 0.0;
        row.exists = meet_ || enclosed_;
        if (!row.exists) return row;
        row.numbers = finish(*this, origin_, self_ != 0);
        if (self_ != 0) row.exists = row.numbers.volume.scaled.mantissa != 0;
        row.relation = self_ != 0 ? OverlapRelation::overlapping : relation();
        for (std::size_t side = 0; side < 2; ++side) row.gradient[side] = gradient(side);
        return row;
    }

    // The sums that finish() asks for.
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

    /// The weights of faces that nothing crosses: the winding number at the first corner.
    Weights uncrossed(const PosedBody& of, const PosedBody& other, Shift shift, bool& enclosed) {
        Weights weights(of.face.size());
        for (std::size_t f = 0; f < of.face.size(); ++f) {
            cancellation_.check();
            const Vec3d p = of.corners(f)[0];
            int winding = 0;
            for (std::size_t g = 0; g < other.face.size(); ++g)
                winding += winding_along_ray(scaled(p, exponent_), in_units(other.corners(g), exponent_), shift);
            weights[f].fill(Rational(winding));
            const std::int32_t vertex = of.name[static_cast<std::size_t>(of.face[f][0])];
            enclosed |= winding != 0 && of.used.contains(vertex);  // a lone point is no component
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
                const RationalCrossing crossing =
                    cross_rationally(in_units(p, exponent_), in_units(q, exponent_), shift);
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

    static double rounded(const Rational& x, int divisor) {
        Cancellation none;
        RationalSum sum;
        sum.add(x);
        return sum.rounded_quotient(divisor, none).value;
    }
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
    Cancellation& cancellation_;
    int exponent_ = 0;
    Vec3d origin_;
    bool meet_ = false, enclosed_ = false;
    Rational six_volumes_ = 0;  ///< of the overlap
    VolumeTotals<RationalSum> volume_totals_;
    CurveTotals<RationalSum> curve_totals_;
    std::array<Gradient, 2> gradient_;
};

}  // namespace

void find_overlaps_by_brute_force(const World& world, const OverlapQuery& query, MemoryMeter& meter,
                                  Cancellation& cancellation, Overlaps& result) {
    WorldOutline outline(&meter);
    outline.read(world, query.filter);
    BodyRules rules(&meter);
    rules.prepare(query.filter);
    begin(query, outline.worlds(), outline.bodies(), result);
    result.statistics.backend = "reference";
    result.statistics.simd = "scalar";
    result.statistics.triangles = outline.triangles();
    std::vector<PosedBody> bodies;
    bodies.reserve(static_cast<std::size_t>(outline.bodies()));
    for (std::int32_t b = 0; b < outline.bodies(); ++b) bodies.push_back(posed_body(outline, b, query.weld));
    std::vector<std::int32_t> skipped;
    for (std::int32_t a = 0; a < outline.bodies(); ++a) {
        for (std::int32_t b = query.self_overlaps ? a : a + 1; b < outline.bodies(); ++b) {
            const Body &one = outline.body(a), &other = outline.body(b);
            if (one.world != other.world && other.world != -1) continue;
            if (!(a == b ? rules.within(a, query.self_overlaps) : rules.between(a, b))) continue;
            if (!rules.groups(one.group, other.group)) continue;
            const PosedBody &p = bodies[static_cast<std::size_t>(a)], &q = bodies[static_cast<std::size_t>(b)];
            if (a != b && !overlap(p.box, q.box)) continue;
            bool open = false;
            for (const auto& [body, index] : {std::pair(&p, a), std::pair(&q, b)}) {
                if (body->open.empty()) continue;
                if (query.open == OpenSurfaces::error)
                    fail_open_surface(index, body->open.size(), body->open.begin()->second);
                open = true;
                skipped.push_back(index);
            }
            if (open) continue;
            const auto orientation = [&](std::int32_t body) {
                return orientation_of(outline.placement(body)) < 0 ? -1 : 1;
            };
            OverlapRow row = BruteForceOverlap(p, q, a == b ? orientation(a) : 0, cancellation).row();
            if (a == b) add_body(a, row, result);
            orient(orientation(a), orientation(b), row);
            if (!query.gradient) row.gradient = {};
            if (!query.windings) row.windings = {};
            if (row.exists && std::abs(row.numbers.volume.value) >= query.min_volume)
                add_row(query, {a, b}, one.world, row, result);
        }
    }
    add_skipped(std::move(skipped), result);
    result.count = static_cast<std::int64_t>(result.bodies.size());
}

}  // namespace crumple
