// Derivatives of the volume of an overlap by the vertices of the bodies: a face gives each of its corners its normal
// times the corner's weight (docs/overlap.md).

#include <algorithm>
#include <map>

#include "search/overlap_placed.h"
#include "search/overlap_row.h"

namespace crumple {
namespace {

struct VertexTerm {
    std::int32_t vertex;
    Vec3<Enclosed> term;
};

bool is_zero(const Enclosed& x) { return x.value.high == 0 && x.error == 0; }

Vec3<Rational> normal_of(const FaceCorners& p) { return placed_rationally(p, p[0]).normal; }

}  // namespace

// Weights of both shifts, and of a body with itself those of both of its copies, of the faces that are wanted.
template <class Number, class Wanted>
WeightedFaces<Number> OverlapOfBodies::all_weights(std::size_t side, std::array<ShiftedSurfaces<Number>, 2>& shifted,
                                                   Wanted wanted) const {
    WeightedFaces<Number> all;
    const auto add = [&](std::int32_t face, const FaceWeights<Number>& weights) {
        if (wanted(face)) all.add(face, weights);
    };
    for (ShiftedSurfaces<Number>& surfaces : shifted)
        for (std::size_t copy = 0; copy < 2; ++copy) {
            if (copy != side && !self_) continue;
            const auto add_inside = [&](std::int32_t face, int winding) {
                const Number w(winding);
                add(face, {w, w, w});
            };
            surfaces[copy].weights.for_each(topology(copy), surfaces[copy].steps, add, add_inside);
        }
    const Number whole(-2 * self_);
    for (std::int32_t face = 0; self_ != 0 && face < topology(0).face_count(); ++face) add(face, {whole, whole, whole});
    all.combine();
    return all;
}

std::vector<VertexVector> OverlapOfBodies::gradient(std::size_t side) {
    std::vector<std::int32_t> undecided;
    std::vector<VertexVector> found;
    const auto all = [](std::int32_t) { return true; };
    if (!in_range()) {
        const WeightedFaces<Rational> weighted = all_weights(side, exact_->shifted, all);
        for (const auto& entry : weighted.entries())
            for (std::size_t k = 0; k < 3; ++k) undecided.push_back(topology(side).corners(entry.face)[k]);
        std::sort(undecided.begin(), undecided.end());
        undecided.erase(std::unique(undecided.begin(), undecided.end()), undecided.end());
        return rational_gradient(side, undecided);
    }
    std::vector<VertexTerm> terms;
    const WeightedFaces<Enclosed> weighted = all_weights(side, quick_, all);
    for (const auto& [face, weights] : weighted.entries()) {
        if (is_zero(weights[0]) && is_zero(weights[1]) && is_zero(weights[2])) continue;
        cancellation_.check();
        const FaceCorners p = surfaces_[side]->corners(face);
        const Vec3<Enclosed> normal = placed_quickly(p, origin_).normal;
        for (std::size_t k = 0; k < 3; ++k) terms.push_back({topology(side).corners(face)[k], weights[k] * normal});
    }
    std::stable_sort(terms.begin(), terms.end(), [](const auto& x, const auto& y) { return x.vertex < y.vertex; });
    for (std::size_t i = 0; i < terms.size();) {
        Vec3<Enclosed> sum = terms[i].term;
        const std::int32_t vertex = terms[i].vertex;
        for (++i; i < terms.size() && terms[i].vertex == vertex; ++i) sum = sum + terms[i].term;
        const auto x = nearest_quotient(sum.x, divisor()), y = nearest_quotient(sum.y, divisor()),
                   z = nearest_quotient(sum.z, divisor());
        if (!x || !y || !z)
            undecided.push_back(vertex);
        else if (*x != 0 || *y != 0 || *z != 0)
            found.push_back({vertex, {*x, *y, *z}});
    }
    if (undecided.empty()) return found;
    const std::vector<VertexVector> rest = rational_gradient(side, undecided);
    found.insert(found.end(), rest.begin(), rest.end());
    std::sort(found.begin(), found.end(), [](const auto& x, const auto& y) { return x.vertex < y.vertex; });
    return found;
}

std::vector<VertexVector> OverlapOfBodies::rational_gradient(std::size_t side,
                                                             const std::vector<std::int32_t>& vertices) {
    const auto is_wanted = [&](std::int32_t vertex) {
        return std::binary_search(vertices.begin(), vertices.end(), vertex);
    };
    const auto has_wanted = [&](std::int32_t face) {
        const std::int32_t* c = topology(side).corners(face);
        return is_wanted(c[0]) || is_wanted(c[1]) || is_wanted(c[2]);
    };
    std::array<ShiftedSurfaces<Rational>, 2> near;
    for (const Pair& pair : pairs_) {
        cancellation_.check();
        if (exact_ || !((side == 0 && has_wanted(pair.a)) || ((side == 1 || self_) && has_wanted(pair.b)))) continue;
        const FaceCorners p = surfaces_[0]->corners(pair.a), q = surfaces_[1]->corners(pair.b);
        for (std::size_t s = 0; s < both_shifts.size(); ++s) {
            const RationalCrossing crossing = cross_rationally(p, q, both_shifts[s]);
            if (!crossing.jumps.segment) continue;
            near[s][0].weights.add(pair.a, crossing.a);
            near[s][1].weights.add(pair.b, crossing.b);
        }
    }
    for (std::size_t s = 0; s < both_shifts.size() && !exact_; ++s)
        for (std::size_t copy = 0; copy < 2; ++copy) {
            near[s][copy].steps = quick_[s][copy].steps;
            near[s][copy].weights.combine();
            near[s][copy].weights.add_windings(topology(copy), near[s][copy].steps);
        }
    std::map<std::int32_t, std::array<RationalSum, 3>> sums;
    const WeightedFaces<Rational> weighted = all_weights(side, exact_ ? exact_->shifted : near, has_wanted);
    for (const auto& [face, weights] : weighted.entries()) {
        cancellation_.check();
        const Vec3<Rational> normal = normal_of(surfaces_[side]->corners(face));
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t vertex = topology(side).corners(face)[k];
            if (!is_wanted(vertex)) continue;
            for (int axis = 0; axis < 3; ++axis)
                sums[vertex][static_cast<std::size_t>(axis)].add(weights[k] * normal[axis]);
        }
    }
    std::vector<VertexVector> found;
    for (const auto& [vertex, sum] : sums) {
        VertexVector row{vertex, {}};
        bool zero = true;
        for (int axis = 0; axis < 3; ++axis) {
            const RoundedSum rounded = sum[static_cast<std::size_t>(axis)].rounded_quotient(divisor(), cancellation_);
            row.value[axis] = rounded.value;
            zero = zero && rounded.scaled.mantissa == 0;
        }
        if (!zero) found.push_back(row);
    }
    return found;
}

}  // namespace crumple
