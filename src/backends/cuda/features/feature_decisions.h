#pragma once

// Decision of a feature test on a device, in two steps. quick() works in float64 and double-double numbers. Only if
// Query::closely is true, close() follows for tests that quick() leaves open, with expansions or enclosures, which need
// more stack. The host decides tests that remain open. Each kind of query is a struct with these two functions. The
// host calls them, too, to check a device (backends/cuda/comparison_cases.h).

#include "backends/cuda/features/exact_points.h"
#include "backends/cuda/features/feature_parameters.h"
#include "exact/impact/filtered_impact.h"
#include "exact/impact/filtered_min_distance.h"
#include "exact/proximity/filtered_distance.h"
#include "filters/features/features_to_decide.h"
#include "filters/features/tests_of_pair.h"

namespace crumple::cuda {

enum class Outcome : std::uint8_t { apart, hit, open };

struct Decided {
    Outcome outcome = Outcome::open;
    double value = 0;   ///< toi, or squared distance
    bool flag = false;  ///< true if the features meet at the start (impacts), or touch (proximities)
};

CRUMPLE_HD inline Decided decided(const FilteredImpact& impact) {
    if (impact.verdict == Certainty::unknown) return {};
    return {impact.verdict == Certainty::meets ? Outcome::hit : Outcome::apart, impact.toi, impact.start};
}

constexpr bool of_triangles(FeatureKind kind) {
    return kind == FeatureKind::vertex_face || kind == FeatureKind::edge_edge;
}
constexpr FeatureKinds kinds_of_constant(FeatureKind kind) { return static_cast<FeatureKinds>(kind); }

/// Decision of contact: when features first touch. A vertex and an edge, or two vertices, are decided by the filter of
/// minimum distances with a distance of 0: such features rarely touch, and a lower bound on their distance is cheap.
/// With `approaching_only`, features that touch at the start are apart, because they cannot come closer.
struct ImpactDecision {
    static constexpr bool closely = true;
    ExactPoints points;
    bool approaching_only;

    explicit ImpactDecision(const ExactPoints& exact, const FeatureConditions& asked, bool)
        : points(exact), approaching_only(asked.approaching_only) {}

    template <FeatureKind kind>
    CRUMPLE_HD Decided quick(const FeatureTest& test) const {
        const Decided found = touching<kind>(test);
        return approaching_only && found.flag ? Decided{Outcome::apart} : found;
    }
    template <FeatureKind kind>
    CRUMPLE_HD Decided close(const FeatureTest& test) const {
        if constexpr (of_triangles(kind)) {
            constexpr FeaturePair pair =
                kind == FeatureKind::vertex_face ? FeaturePair::vertex_face : FeaturePair::edge_edge;
            if (contact_at_start<pair>(points.moving(test.vertex)) > 0)
                return approaching_only ? Decided{Outcome::apart} : Decided{Outcome::hit, 0, true};
        }
        return {};
    }

   private:
    template <FeatureKind kind>
    CRUMPLE_HD Decided touching(const FeatureTest& test) const {
        const FeaturePoints p = points.moving(test.vertex);
        if constexpr (!of_triangles(kind)) {
            return decided(filtered_min_distance<kinds_of_constant(kind)>(p, MinDistance{}));
        } else {
            constexpr FeaturePair pair =
                kind == FeatureKind::vertex_face ? FeaturePair::vertex_face : FeaturePair::edge_edge;
            const Approach<pair> x(p);
            if (!x.in_range()) return {};
            return decided(first_impact(p, x, Volume(x)));
        }
    }
};

/// Decision of approach: when features come within a distance. With `approaching_only`, tests of features that start
/// within it stay open, for the host.
struct MinDistanceDecision {
    static constexpr bool closely = false;
    ExactPoints points;
    MinDistance separation;

    MinDistanceDecision(const ExactPoints& exact, const FeatureConditions& asked, bool)
        : points(exact), separation{asked.distance, asked.share, asked.approaching_only} {}

    template <FeatureKind kind>
    CRUMPLE_HD Decided quick(const FeatureTest& test) const {
        const Decided found =
            decided(filtered_min_distance<kinds_of_constant(kind)>(points.moving(test.vertex), separation));
        return separation.approaching_only && found.flag ? Decided{} : found;
    }
    template <FeatureKind>
    CRUMPLE_HD Decided close(const FeatureTest&) const {
        return {};
    }
};

/// Decision of a proximity: whether features are near, and their distance.
struct ProximityDecision {
    static constexpr bool closely = true;
    ExactPoints points;
    double distance;
    bool strict, any;
    const double* radii;
    RestTable rest;

    ProximityDecision(const ExactPoints& exact, const FeatureConditions& asked, bool any_only)
        : points(exact),
          distance(asked.distance),
          strict(asked.strict),
          any(any_only),
          radii(asked.radii),
          rest(asked.rest) {}

    template <FeatureKind kind>
    CRUMPLE_HD Decided quick(const FeatureTest& test) const {
        const FilteredDistance between({kinds_of_constant(kind), points.start(test.vertex)});
        const Proximity known =
            between.compare_in_float64(distance_limit_of(kind, test.vertex, radii, distance, strict));
        if (known == Proximity::beyond) return {Outcome::apart};
        return {known == Proximity::within && any && !rest.position ? Outcome::hit : Outcome::open};
    }
    template <FeatureKind kind>
    CRUMPLE_HD Decided close(const FeatureTest& test) const {
        const FilteredDistance between({kinds_of_constant(kind), points.start(test.vertex)});
        const Proximity known = between.compare(distance_limit_of(kind, test.vertex, radii, distance, strict));
        if (known != Proximity::within) return {known == Proximity::beyond ? Outcome::apart : Outcome::open};
        if (rest.knows(test.vertex[0], test.vertex[3])) {
            const Proximity at_rest =
                FilteredDistance({kinds_of_constant(kind), resting(test.vertex)}).compare({rest.radius, 0});
            if (at_rest != Proximity::beyond) return {at_rest == Proximity::within ? Outcome::apart : Outcome::open};
        }
        crumple::detail::Enclosure enclosure = between.enclosure();
        Decided decision{Outcome::hit};
        decision.flag = enclosure.touching();
        if (!decision.flag && !enclosure.apart()) return {};
        return enclosure.squared_rounded(decision.value) ? decision : Decided{};
    }

   private:
    CRUMPLE_HD std::array<Vec3d, 4> resting(const std::int32_t (&v)[4]) const {
        return {rest(v[0]), rest(v[1]), rest(v[2]), rest(v[3])};
    }
};

}  // namespace crumple::cuda
