// Compares impacts and proximities of small hard soups, for each of the tested detectors, with brute force in rational
// arithmetic, value by value.

#include <gtest/gtest.h>

#include "features/moving_soups.h"
#include "features/tested_detectors.h"
#include "rounds.h"

namespace crumple::test {
namespace {

template <class Scalar>
class FeatureAgreement : public testing::Test {
   protected:
    /// `part`: see moving_soups().
    template <class Work>
    void for_each_soup(Work work, double part = 1) {
        for (const NamedMove<Scalar>& move : soups_to_try<Scalar>(part, 0.3)) {
            SCOPED_TRACE(move.name);
            work(move);
            if (this->HasFailure()) return;
        }
    }
    void expect_within_distance(double min_distance, double share) {
        SCOPED_TRACE(testing::Message() << "separation " << min_distance << ", share " << share);
        const auto work = [&](const NamedMove<Scalar>& move) {
            const double distance = min_distance * move.unit;
            if (distance > 1e300) return;
            const ImpactQuery query{.min_distance = distance, .min_distance_share = share};
            std::vector<const TestedDetector*> by{&tested()[1]};
            if (share == 0) by.push_back(&tested()[2]);
            expect_impacts(move.soup, query, by);
        };
        for_each_soup(work, share > 0 ? 0.12 : 0.2);  // with a share, every pair needs the exact decision
    }
};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(FeatureAgreement, Precisions, PrecisionNames);

TYPED_TEST(FeatureAgreement, impacts_match_brute_force) {
    this->for_each_soup([](const auto& move) { expect_impacts(move.soup, {}); });
}

TYPED_TEST(FeatureAgreement, impacts_within_a_distance_match_brute_force) {
    for (const double min_distance : {1e-3, 0.75, 1.0, 1e9}) this->expect_within_distance(min_distance, 0);
}

TYPED_TEST(FeatureAgreement, impacts_within_a_distance_share_match_brute_force) {
    for (const double share : {0.5, 1 - 0x1p-53}) this->expect_within_distance(0, share);
    this->expect_within_distance(1, 0.75);
}

TYPED_TEST(FeatureAgreement, approaching_impacts_match_brute_force) {
    const auto work = [&](const auto& move) {
        expect_impacts(move.soup, {.approaching_only = true});
        if (move.unit > 1e300) return;
        const ImpactQuery query{.min_distance = 0.75 * move.unit, .approaching_only = true};
        expect_impacts(move.soup, query, {&tested()[1], &tested()[2]});
    };
    this->for_each_soup(work, 0.05);
}

TYPED_TEST(FeatureAgreement, welded_impacts_match_brute_force) {
    this->for_each_soup([](const auto& move) { expect_impacts(move.soup, {.weld = true}); });
}

TYPED_TEST(FeatureAgreement, static_contacts_match_brute_force) {
    this->for_each_soup([](const auto& move) {
        auto soup = move.soup;
        soup.end = soup.start;
        expect_impacts(soup, {});
        expect_near(soup, {});
        expect_near(soup, {.weld = true});
    });
}

TYPED_TEST(FeatureAgreement, proximities_match_brute_force) {
    for (const double radius : {1e-3, 1.0, 3.0, 1e9})
        for (const bool strict : {false, true}) {
            if (strict && radius != 1) continue;
            const std::size_t most = radius < 1 ? 300 : radius < 4 ? 40 : 20;
            SCOPED_TRACE(testing::Message() << "radius " << radius << (strict ? ", strict" : ""));
            this->for_each_soup([&](const auto& move) {
                if (radius * move.unit > 1e300 || move.soup.triangles.size() > most) return;
                expect_near(move.soup, {.radius = radius * move.unit, .strict = strict});
            });
        }
}

/// A few triangles near 0, in a leaf of their own, approach each other by small steps. Other triangles are so far away
/// that, relative to the size of the scene, squares of these steps underflow in float32.
TEST(FeatureExtremes, small_steps_in_a_large_scene_match_brute_force) {
    for (int exponent = -5; exponent >= -22; exponent -= sanitized || played ? 4 : 1) {
        const double step = std::pow(10, exponent);
        MovingSoup<> soup;
        const auto add = [&](double x, double y, double size, double way) {
            const std::int32_t a = soup.vertex({x, y, 0}, {x + way, y, 0});
            soup.vertex({x, y + size, 0}, {x + way, y + size, 0});
            soup.vertex({x, y, size}, {x + way, y, size});
            soup.triangles.push_back({a, a + 1, a + 2});
        };
        for (int i = 0; i < 6; ++i) {
            add(0, i * 5 * step, step, step);
            add(3.8 * step, i * 5 * step, step, -step);  // their distance shrinks from 3.8 to 1.8 steps
            add(1, 0.1 * i, 0.05, 0.01);
            add(-1, 0.1 * i, 0.05, 0.01);
        }
        SCOPED_TRACE(step);
        expect_impacts(soup, {.min_distance_share = 0.5}, {&tested()[1], &tested()[2]});
        expect_impacts(soup, {.min_distance = 2 * step}, {&tested()[1], &tested()[2]});
        if (HasFailure()) return;
    }
}

}  // namespace
}  // namespace crumple::test
