// Invariants of overlaps when bodies are exchanged, turned, mirrored, scaled, moved, reversed, joined or subdivided,
// and sums of derivatives of volumes.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "overlaps/closed_bodies.h"
#include "rounds.h"

namespace crumple {
namespace {

using test::Dice;
using Soup = test::Soup<double>;
using Numbers = std::array<double, 3>;
using test::joined;

/// Row of the overlap of two bodies.
struct Row {
    bool exists = false;
    OverlapRelation relation = OverlapRelation::touching;
    double volume = 0;
    Numbers centroid{}, area_vector{}, torque{}, torque_point{};
    double contact_area = 0;
};

Row overlap_of(const Soup& a, const Soup& b) {
    Detector detector(Options{.backend = Backend::cpu, .threads = 1});
    const Overlaps& found = detector.find({a.view(), b.view()}, OverlapQuery());
    if (found.count == 0) return {};
    return {true,
            found.relation[0],
            found.volume[0],
            found.centroid[0],
            found.area_vector[0],
            found.torque[0],
            found.torque_point[0],
            found.contact_area[0]};
}

Soup changed(Soup soup, const std::function<void(std::array<double, 3>&)>& change) {
    for (auto& p : soup.vertices) change(p);
    return soup;
}
Soup reversed(Soup soup) {
    for (auto& t : soup.triangles) std::swap(t[1], t[2]);
    return soup;
}
/// Returns the soup on a fine grid, where sums and halves are exact.
Soup with_few_bits(const Soup& soup) {
    return changed(soup, [](auto& p) {
        for (double& x : p) x = std::ldexp(std::round(std::ldexp(x, 24)), -24);
    });
}
/// Returns the soup with a vertex inside each face, which is exact as corners have few bits.
Soup subdivided(const Soup& soup) {
    Soup fine;
    fine.vertices = soup.vertices;
    for (const auto& t : soup.triangles) {
        const auto middle = static_cast<std::int32_t>(fine.vertices.size());
        auto& p = fine.vertices.emplace_back();
        const auto at = [&](std::size_t k) { return soup.vertices[static_cast<std::size_t>(t[k])]; };
        for (std::size_t axis = 0; axis < 3; ++axis) p[axis] = (at(0)[axis] + at(1)[axis] + 2 * at(2)[axis]) / 4;
        for (std::size_t k = 0; k < 3; ++k) fine.triangles.push_back({t[k], t[(k + 1) % 3], middle});
    }
    return fine;
}

void expect_near(const Numbers& found, const Numbers& expected, double scale) {
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(found[k], expected[k], 1e-15 * scale);
}
/// Expects equal rows up to the sign of 0. Compares centroids and torques approximately: centroids are rounded, and
/// torques are about centroids.
void expect_same(const Row& found, const Row& expected) {
    ASSERT_EQ(found.exists, expected.exists);
    if (!found.exists) return;
    EXPECT_EQ(found.relation, expected.relation);
    EXPECT_EQ(found.volume, expected.volume);
    EXPECT_EQ(found.area_vector, expected.area_vector);
    EXPECT_EQ(found.contact_area, expected.contact_area);
    if (found.volume != 0) expect_near(found.centroid, expected.centroid, 16);
    expect_near(found.torque, expected.torque, 64);
}

OverlapRelation exchanged(OverlapRelation relation) {
    return relation == OverlapRelation::first_inside    ? OverlapRelation::second_inside
           : relation == OverlapRelation::second_inside ? OverlapRelation::first_inside
                                                        : relation;
}
Numbers operator-(const Numbers& v) { return {-v[0], -v[1], -v[2]}; }
/// Returns the row of the bodies in the opposite order.
Row exchanged(Row row) {
    row.relation = exchanged(row.relation);
    row.area_vector = -row.area_vector;
    row.torque = -row.torque;
    return row;
}

class OverlapProperties : public testing::TestWithParam<bool> {
   protected:
    /// Calls check(a, b) for pairs of bodies, on a grid if the test's parameter is true.
    template <class Check>
    void for_pairs(int count, Check check) {
        for (unsigned seed = 0; seed < static_cast<unsigned>(scaled_rounds(count)); ++seed) {
            SCOPED_TRACE(seed);
            const test::ClosedBodies bodies = test::closed_bodies(500 + seed, 2, GetParam(), false);
            check(bodies.soups[0], bodies.soups[1]);
        }
    }
};

TEST_P(OverlapProperties, exchanged_bodies_have_opposite_area_vectors) {
    for_pairs(40, [](const Soup& a, const Soup& b) { expect_same(overlap_of(b, a), exchanged(overlap_of(a, b))); });
}

TEST_P(OverlapProperties, permuted_and_mirrored_axes_transform_the_result) {
    std::array<std::size_t, 3> axes{0, 1, 2};
    const auto check = [&](const Soup& a, const Soup& b, int mirrored) {
        const auto change = [&](std::array<double, 3>& p) {
            std::array<double, 3> q{};
            for (std::size_t k = 0; k < 3; ++k) q[k] = (mirrored >> k & 1 ? -1 : 1) * p[axes[k]];
            p = q;
        };
        const bool odd_axes = (axes[1] == (axes[0] + 1) % 3) == false;
        const bool turns_inside_out = odd_axes != ((mirrored ^ mirrored >> 1 ^ mirrored >> 2) & 1);
        const auto moved = [&](const Soup& soup) {
            const Soup transformed = changed(soup, change);
            return turns_inside_out ? reversed(transformed) : transformed;
        };
        Row expected = overlap_of(a, b);
        change(expected.centroid);
        change(expected.area_vector);
        change(expected.torque);
        if (turns_inside_out) expected.torque = -expected.torque;  // a pseudovector
        expect_same(overlap_of(moved(a), moved(b)), expected);
    };
    for_pairs(12, [&](const Soup& a, const Soup& b) {
        do {
            for (const int mirrored : {0, 1, 6, 7}) check(a, b, mirrored);
        } while (std::next_permutation(axes.begin(), axes.end()));
    });
}

TEST_P(OverlapProperties, powers_of_two_scale_the_result) {
    for (const int power : {-40, 3, 100}) {
        const auto scaled = [&](const Soup& soup) {
            return changed(soup, [&](auto& p) {
                for (double& x : p) x = std::ldexp(x, power);
            });
        };
        for_pairs(12, [&](const Soup& a, const Soup& b) {
            const Row plain = overlap_of(a, b);
            Row found = overlap_of(scaled(a), scaled(b));
            found.volume = std::ldexp(found.volume, -3 * power);
            found.contact_area = std::ldexp(found.contact_area, -2 * power);
            for (std::size_t k = 0; k < 3; ++k) {
                found.centroid[k] = std::ldexp(found.centroid[k], -power);
                found.area_vector[k] = std::ldexp(found.area_vector[k], -2 * power);
                found.torque[k] = std::ldexp(found.torque[k], -3 * power);
            }
            expect_same(found, plain);
        });
    }
}

TEST_P(OverlapProperties, exact_translations_move_the_centroid_but_keep_volume_and_area_vector) {
    const Numbers by{1024, -3, 0.5};
    const auto moved = [&](const Soup& soup) {
        return changed(soup, [&](auto& p) {
            for (std::size_t k = 0; k < 3; ++k) p[k] += by[k];
        });
    };
    for_pairs(40, [&](const Soup& one, const Soup& other) {
        const Soup a = with_few_bits(one), b = with_few_bits(other);
        Row expected = overlap_of(a, b), found = overlap_of(moved(a), moved(b));
        for (std::size_t k = 0; k < 3; ++k) found.centroid[k] -= by[k];
        if (found.volume != 0) expect_near(found.centroid, expected.centroid, 1024);
        found.centroid = expected.centroid;
        found.torque = expected.torque;  // not compared: centroids farther from 0 are rounded more coarsely
        expect_same(found, expected);
    });
}

TEST_P(OverlapProperties, reversing_a_body_negates_the_volume_and_area_vector) {
    for_pairs(40, [](const Soup& a, const Soup& b) {
        const Row plain = overlap_of(a, b);
        Row found = overlap_of(reversed(a), b);
        found.volume = -found.volume + 0.0;
        found.area_vector = -found.area_vector;
        found.torque = -found.torque;
        expect_same(found, plain);
    });
}

TEST_P(OverlapProperties, subdivided_faces_change_neither_volume_nor_area_vector) {
    for_pairs(40, [](const Soup& one, const Soup& other) {
        const Soup a = with_few_bits(one), b = with_few_bits(other);
        const Row plain = overlap_of(a, b);
        expect_same(overlap_of(subdivided(a), b), plain);
        expect_same(overlap_of(a, subdivided(subdivided(b))), plain);
    });
}

TEST_P(OverlapProperties, volumes_and_area_vectors_of_separate_parts_add_up) {
    for_pairs(20, [](const Soup& a, const Soup& b) {
        const Soup away = changed(b, [](auto& p) { p[0] += 64; });
        const Soup both = joined(a, changed(a, [](auto& p) { p[0] += 64; }));
        const Row once = overlap_of(a, b), twice = overlap_of(both, joined(b, away));
        EXPECT_NEAR(twice.volume, 2 * once.volume, 1e-13);
        for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(twice.area_vector[k], 2 * once.area_vector[k], 1e-12);
    });
}

/// Sums of the area vectors and torques of all curves, as seen from the first body.
struct CurveSums {
    Numbers area{}, torque{};
    bool all_closed = true;
};
CurveSums curves_of(const Soup& a, const Soup& b) {
    Detector detector(Options{.backend = Backend::cpu, .threads = 1});
    const Overlaps& found = detector.find({a.view(), b.view()}, OverlapQuery{.curves = true});
    CurveSums sums;
    for (std::size_t j = 0; j < found.curve_closed.size(); ++j) {
        sums.all_closed = sums.all_closed && found.curve_closed[j] == 1;
        for (std::size_t k = 0; k < 3; ++k) {
            sums.area[k] += found.curve_area_vector[j][k];
            sums.torque[k] += found.curve_torque[j][k];
        }
    }
    return sums;
}

TEST_P(OverlapProperties, curve_areas_of_exchanged_bodies_differ_by_twice_the_area_vector) {
    for_pairs(60, [](const Soup& a, const Soup& b) {
        const Row row = overlap_of(a, b);
        const CurveSums one = curves_of(a, b), other = curves_of(b, a);
        EXPECT_TRUE(one.all_closed && other.all_closed);
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_NEAR(one.area[k] - other.area[k], 2 * row.area_vector[k], 1e-13);
            // Torques of both orders are about the same point.
            EXPECT_NEAR(one.torque[k] - other.torque[k], 2 * row.torque[k], 1e-12);
        }
    });
}

TEST_P(OverlapProperties, derivatives_sum_to_the_area_vector_and_obey_eulers_identity) {
    for_pairs(20, [](const Soup& a, const Soup& b) {
        Detector detector(Options{.backend = Backend::cpu, .threads = 1});
        const Overlaps& found = detector.find({a.view(), b.view()}, OverlapQuery{.gradient = true});
        if (found.count == 0) return;
        Numbers sum_a{}, sum_b{};
        double euler = 0;
        for (std::size_t i = 0; i < found.gradient.size(); ++i) {
            const auto [body, vertex] = found.gradient_vertices[i];
            const auto& p = (body == 0 ? a : b).vertices[static_cast<std::size_t>(vertex)];
            for (std::size_t k = 0; k < 3; ++k) {
                (body == 0 ? sum_a : sum_b)[k] += found.gradient[i][k];
                euler += found.gradient[i][k] * p[k];
            }
        }
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_NEAR(sum_a[k], found.area_vector[0][k], 1e-13);
            EXPECT_NEAR(sum_b[k], -found.area_vector[0][k], 1e-13);
        }
        EXPECT_NEAR(euler, 3 * found.volume[0], 1e-12);
    });
}

TEST_P(OverlapProperties, solid_body_and_its_copy_overlap_in_the_whole_volume) {
    for_pairs(20, [](const Soup& a, const Soup&) {
        Detector detector(Options{.backend = Backend::cpu, .threads = 1});
        const double own = detector.find(Scene(a.view()), OverlapQuery()).body_volume[0];
        const bool solid = detector.find(Scene(a.view()), OverlapQuery()).is_solid[0] != 0;
        const Row found = overlap_of(a, a);
        if (solid && own > 0) {
            EXPECT_EQ(found.volume, own);
            EXPECT_EQ(found.relation, OverlapRelation::equal);
        }
        EXPECT_EQ(found.area_vector, Numbers{});
    });
}

INSTANTIATE_TEST_SUITE_P(OnAGridAndAnywhere, OverlapProperties, testing::Bool());

}  // namespace
}  // namespace crumple
