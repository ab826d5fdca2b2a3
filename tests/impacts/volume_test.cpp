// Checks by rational arithmetic the error bounds of filters that compute the volume: the determinant of three vectors
// between four moving points, a cubic polynomial in time.

#include <gtest/gtest.h>

#include <cmath>

#include "exact/impact/volume.h"
#include "exact/integer.h"
#include "impacts/random_moves.h"

namespace crumple {
namespace {

using Rational = mp::cpp_rational;

/// Returns u, v and w at time t.
template <FeaturePair pair>
std::array<Vec3<Rational>, 3> exact_vectors(const FourPoints& points, const Rational& t) {
    return vectors<pair>(points, [&](const MovingPoint& to, const MovingPoint& from) {
        Vec3<Rational> vector;
        for (int i = 0; i < 3; ++i) {
            const Rational start = Rational(to.start[i]) - Rational(from.start[i]);
            const Rational end = Rational(to.end[i]) - Rational(from.end[i]);
            vector[i] = start + t * (end - start);
        }
        return vector;
    });
}

template <FeaturePair pair>
Rational exact_volume(const FourPoints& points, const Rational& t) {
    const auto [u, v, w] = exact_vectors<pair>(points, t);
    return dot(cross(u, v), w);
}

/// Returns the error of a number as a share of its bound.
double share(double computed, const Rational& exact, double bound) {
    const Rational off = mp::abs(Rational(Rational(computed) - exact));
    return static_cast<double>(Rational(off / Rational(bound)));
}

/// Returns points whose coordinates have full mantissas. `round` determines whether they have similar or mixed
/// magnitudes, and whether their volume is nearly 0.
FourPoints random_points(RandomMoves& random, int round) {
    FourPoints points = random(Feature::edge_edge).point;
    const double flat = round % 4 == 0 ? 1 : std::ldexp(1, -round % 60);
    for (MovingPoint& p : points) {
        for (int i = 0; i < 3; ++i) {
            for (double* x : {&p.start[i], &p.end[i]}) {
                *x += random.below(1 << 30) * 0x1p-30 + random.below(1 << 30) * 0x1p-52;
                if (i == 2) *x *= flat;
                if (round % 3 == 0) *x = std::ldexp(*x, random.below(30));
                if (round % 7 == 0) *x = std::ldexp(*x, -360);
            }
        }
        if (round % 5 == 0) p.end.z = p.start.z = p.start.x + p.start.y;
    }
    return points;
}

template <FeaturePair pair>
void check_volume() {
    RandomMoves random(Lattice::wide, 59);
    double largest = 0, largest_derivative = 0, largest_coefficient = 0, largest_precise = 0;
    for (int round = 0; round < 400; ++round) {
        const FourPoints points = random_points(random, round);
        const Approach<pair> x(points);
        const Volume volume(x);
        const auto f = [&](const Rational& t) { return exact_volume<pair>(points, t); };
        // The coefficients of the cubic polynomial, from its values at four times.
        const Rational f0 = f(0), f1 = f(1), half = f(Rational(1) / 2), twice = f(2);
        const Rational c3 = (twice - 2 * f1 + f0) / 2 - (f1 - 2 * half + f0) * 2, cubic = c3 * 2 / 3;
        const Rational square = (f1 - 2 * half + f0) * 2 - cubic * 3 / 2, linear = f1 - f0 - square - cubic;
        ASSERT_EQ(f(3), f0 + 3 * linear + 9 * square + 27 * cubic);
        const auto blossom = [&](const Rational& r, const Rational& s, const Rational& t) -> Rational {
            return f0 + linear * (r + s + t) / 3 + square * (r * s + s * t + t * r) / 3 + cubic * r * s * t;
        };

        for (const double t : {0., 1., random.below(1 << 30) * 0x1p-30, random.below(1 << 30) * 0x1p-52, 1 - 0x1p-53}) {
            const auto [value, derivative] = volume.slope(t);
            const Rational exact_t(t);
            largest = std::max(largest, share(value, f(exact_t), volume.bound()));
            largest_derivative = std::max(
                largest_derivative, share(derivative, linear + 2 * square * exact_t + 3 * cubic * exact_t * exact_t,
                                          volume.derivative_bound()));
            ASSERT_LE(mp::abs(Rational(2 * square + 6 * cubic * exact_t)), Rational(volume.bend()));
            const DoubleWord precise = precise_volume<pair>(points, t);
            largest_precise = std::max(
                largest_precise, share(precise.high, f(exact_t) - Rational(precise.low), precise_volume_bound(x)));
        }
        const double low = random.below(1 << 20) * 0x1p-21, high = low + random.below(1 << 20) * 0x1p-21;
        const Rational l(low), h(high);
        const std::array<Rational, 4> exact{blossom(l, l, l), blossom(l, l, h), blossom(l, h, h), blossom(h, h, h)};
        const auto computed = volume.coefficients(low, high);
        for (std::size_t i = 0; i < 4; ++i)
            largest_coefficient = std::max(largest_coefficient, share(computed[i], exact[i], volume.bound()));
    }
    for (const double part : {largest, largest_derivative, largest_coefficient, largest_precise}) {
        EXPECT_LT(part, 1);
        EXPECT_GT(part, 0.001) << "a bound that says nothing, or none that is put to the test";
    }
}

TEST(Volume, errors_for_vertex_and_face_are_within_their_bounds) { check_volume<FeaturePair::vertex_face>(); }
TEST(Volume, errors_for_two_edges_are_within_their_bounds) { check_volume<FeaturePair::edge_edge>(); }

}  // namespace
}  // namespace crumple
