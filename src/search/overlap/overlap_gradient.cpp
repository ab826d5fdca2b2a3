// Derivatives of the volume of an overlap with respect to the vertices of the bodies. The contribution of a face to the
// derivative at a corner is the face's normal times the corner's weight (exact/overlap/crossing.h, docs/overlap.md).
// Crossings are decided for two shifts of the second body, forward and backward (exact/overlap/face_crossing.h), and
// the mean of both is the result.

#include <algorithm>
#include <map>

#include "exact/overlap/exact_crossing.h"
#include "exact/overlap/filtered_crossing.h"
#include "search/overlap/overlap_enclosed.h"
#include "search/overlap/overlap_row.h"

namespace crumple {
namespace {

struct VertexTerm {
    std::int32_t vertex;
    Vec3<Enclosed> term;
};

bool is_zero(const Enclosed& x) { return x.value.high == 0 && x.error == 0; }

Vec3<Enclosed> enclosed_normal(const FaceCorners& p) {
    return cross(enclosed_difference(p[1], p[0]), enclosed_difference(p[2], p[0]));
}
Vec3<Rational> rational(const Vec3d& p) { return {Rational(p.x), Rational(p.y), Rational(p.z)}; }
Vec3<Rational> rational_normal(const FaceCorners& p) {
    return cross(rational(p[1]) - rational(p[0]), rational(p[2]) - rational(p[0]));
}

FaceWeights<Enclosed> enclosed(const FaceWeights<Rational>& w) {
    return {crumple::enclosed(w[0]), crumple::enclosed(w[1]), crumple::enclosed(w[2])};
}

/// Crossings of two faces under both shifts, with weights that are exact or have an error bound.
template <class Number>
struct BothCrossings;
template <>
struct BothCrossings<Rational> {
    std::array<RationalCrossing, 2> shifted;

    BothCrossings(const FaceCorners& a, const FaceCorners& b) {
        for (std::size_t s = 0; s < both_shifts.size(); ++s) shifted[s] = cross_rationally(a, b, both_shifts[s]);
    }
};
template <>
struct BothCrossings<Enclosed> {
    std::array<FilteredCrossing, 2> shifted;

    BothCrossings(const FaceCorners& p, const FaceCorners& q) {
        const CrossedFace a(p), b(q);
        for (std::size_t s = 0; s < both_shifts.size(); ++s) {
            if (s == 1 && !shifted[0].tied) {
                shifted[1] = shifted[0];
                break;
            }
            shifted[s] = filter_crossing(a, b, both_shifts[s]);
            if (shifted[s].certain) continue;
            const RationalCrossing exact = cross_rationally(p, q, both_shifts[s]);
            shifted[s].a = enclosed(exact.a);
            shifted[s].b = enclosed(exact.b);
        }
    }
};

}  // namespace

// Returns the weights of the faces of body `side` that the predicate selects: the sum over both shifts and, for a body
// with itself, over both copies of the body.
template <class Number, class Wanted>
WeightedFaces<Number> OverlapOfBodies::weigh(std::size_t side, Wanted wanted) const {
    std::array<std::array<WeightedFaces<Number>, 2>, 2> weights;  // by shift and copy
    for (const Pair& pair : pairs_) {
        cancellation_.check();
        const bool a = (side == 0 || self_) && wanted(pair.a), b = (side == 1 || self_) && wanted(pair.b);
        if (!a && !b) continue;
        const BothCrossings<Number> crossing(body(0).corners(pair.a), body(1).corners(pair.b));
        for (std::size_t s = 0; s < both_shifts.size(); ++s) {
            if (!crossing.shifted[s].jumps.segment) continue;
            if (a) weights[s][0].add(pair.a, crossing.shifted[s].a);
            if (b) weights[s][1].add(pair.b, crossing.shifted[s].b);
        }
    }
    MemoryClaim memory(meter_);
    for (const auto& shifted : weights)
        for (const WeightedFaces<Number>& of_copy : shifted) memory.add(of_copy.bytes());
    WeightedFaces<Number> all;
    const auto add = [&](std::int32_t face, const FaceWeights<Number>& w) {
        if (wanted(face)) all.add(face, w);
    };
    const auto add_whole = [&](std::int32_t face, int winding) {
        const Number w(winding);
        add(face, {w, w, w});
    };
    for (std::size_t s = 0; s < both_shifts.size(); ++s)
        for (std::size_t copy = 0; copy < 2; ++copy) {
            if (copy != side && !self_) continue;
            const WindingSteps& steps = steps_[s][copy];
            weights[s][copy].combine();
            weights[s][copy].add_windings(topology(copy), steps);
            weights[s][copy].for_each(topology(copy), steps, add, add_whole);
        }
    for (std::int32_t face = 0; self_ != 0 && face < topology(0).face_count(); ++face) add_whole(face, -2 * self_);
    all.combine();
    return all;
}

std::vector<VertexVector> OverlapOfBodies::gradient(std::size_t side) {
    std::vector<std::int32_t> undecided;
    std::vector<VertexVector> found;
    if (!in_range()) {
        for (std::int32_t place = 0; place < topology(side).places(); ++place)
            undecided.push_back(topology(side).vertex_at_place(place));
        std::sort(undecided.begin(), undecided.end());
        return rational_gradient(side, undecided);
    }
    std::vector<VertexTerm> terms;
    const WeightedFaces<Enclosed> weighted = weigh<Enclosed>(side, [](std::int32_t) { return true; });
    for (const auto& [face, weights] : weighted.entries()) {
        if (is_zero(weights[0]) && is_zero(weights[1]) && is_zero(weights[2])) continue;
        const Vec3<Enclosed> normal = enclosed_normal(body(side).corners(face));
        for (std::size_t k = 0; k < 3; ++k) terms.push_back({topology(side).corners(face)[k], weights[k] * normal});
    }
    MemoryClaim memory(meter_);
    memory.add(weighted.bytes() + bytes_of(terms));
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

// Returns the derivatives with respect to the given vertices, which are sorted.
std::vector<VertexVector> OverlapOfBodies::rational_gradient(std::size_t side,
                                                             const std::vector<std::int32_t>& vertices) {
    was_exact_ = true;
    const auto is_selected = [&](std::int32_t vertex) {
        return std::binary_search(vertices.begin(), vertices.end(), vertex);
    };
    const auto is_selected_face = [&](std::int32_t face) {
        const std::int32_t* c = topology(side).corners(face);
        return is_selected(c[0]) || is_selected(c[1]) || is_selected(c[2]);
    };
    std::map<std::int32_t, std::array<RationalSum, 3>> sums;
    const WeightedFaces<Rational> weighted = weigh<Rational>(side, is_selected_face);
    for (const auto& [face, weights] : weighted.entries()) {
        cancellation_.check();
        const Vec3<Rational> normal = rational_normal(body(side).corners(face));
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t vertex = topology(side).corners(face)[k];
            if (!is_selected(vertex)) continue;
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
