#include "partition/fuzzy_c_means.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace crumple {
namespace {

std::vector<Vec3f> two_blobs() {
    std::mt19937 engine(3);
    const auto number = [&] { return static_cast<float>(static_cast<double>(engine()) * 0x1p-32 - 0.5); };
    std::vector<Vec3f> points;
    for (int i = 0; i < 500; ++i) {
        const float x = i < 250 ? 0.8f : -0.8f;
        points.push_back({x + 0.1f * number(), 0.1f * number(), 0.1f * number()});
    }
    return points;
}

/// Returns the sum that fuzzy C-means minimises, by eqs. 2 and 3 of [MZ], the paper that the library follows
/// (ARCHITECTURE.md). `t`: exponent of the memberships (fuzziness).
double objective(const std::vector<Vec3f>& points, const Centres& centres, double t) {
    double q = 0;
    for (const Vec3f& p : points) {
        std::vector<double> d2;
        for (int k = 0; k < centres.count; ++k) {
            const Vec3f d = p - centres[k];
            d2.push_back(static_cast<double>(dot(d, d)) + 1e-30);
        }
        for (double dk : d2) {
            double sum = 0;
            for (double dj : d2) sum += std::pow(dk / dj, 1 / (t - 1));
            q += std::pow(1 / sum, t) * dk;
        }
    }
    return q;
}

/// Returns two centres that start between the blobs, on the side of the same one.
Centres centres_beside_one_blob() {
    Centres centres{.count = 2};
    centres.set(0, {0.3f, 0, 0});
    centres.set(1, {0.2f, 0.1f, 0});
    return centres;
}

TEST(FuzzyCMeans, centres_find_two_separate_blobs) {
    const auto points = two_blobs();
    const auto point = [&](std::size_t i) { return points[i]; };
    for (const double t : {2.0, 1.5, 3.0}) {
        Centres centres = centres_beside_one_blob();
        fuzzy_c_means(points.size(), point, {.fuzziness = t, .iterations = 50, .stop = 1e-6}, centres);
        EXPECT_NEAR(std::max(centres[0].x, centres[1].x), 0.8, 0.01) << "t = " << t;
        EXPECT_NEAR(std::min(centres[0].x, centres[1].x), -0.8, 0.01) << "t = " << t;
        for (int k = 0; k < 2; ++k) {
            EXPECT_NEAR(centres[k].y, 0, 0.01) << "t = " << t;
            EXPECT_NEAR(centres[k].z, 0, 0.01) << "t = " << t;
        }
    }
}

TEST(FuzzyCMeans, no_iteration_raises_the_objective_beyond_rounding) {
    const auto points = two_blobs();
    const auto point = [&](std::size_t i) { return points[i]; };
    for (const double t : {2.0, 1.7}) {
        Centres centres;
        start_centres(5, points.size(), point, centres);
        double last = objective(points, centres, t);
        for (int i = 0; i < 10; ++i) {
            fuzzy_c_means(points.size(), point, {.fuzziness = t, .iterations = 1}, centres);
            const double now = objective(points, centres, t);
            EXPECT_LE(now, last * (1 + 1e-5)) << "t = " << t << ", iteration " << i;
            last = now;
        }
    }
}

TEST(FuzzyCMeans, iterations_end_early_once_centres_hardly_move) {
    const auto points = two_blobs();
    const auto point = [&](std::size_t i) { return points[i]; };
    Centres centres = centres_beside_one_blob();
    const int first = fuzzy_c_means(points.size(), point, {.iterations = 100, .stop = 1e-4}, centres);
    EXPECT_GT(first, 2);
    EXPECT_LT(first, 100);
    EXPECT_EQ(fuzzy_c_means(points.size(), point, {.iterations = 100, .stop = 1e-3}, centres), 1);
}

TEST(FuzzyCMeans, centres_of_coincident_points_stay_at_the_point) {
    const std::vector<Vec3f> points(20, Vec3f{0.5f, 0.25f, 0});
    const auto point = [&](std::size_t i) { return points[i]; };
    Centres centres;
    start_centres(4, points.size(), point, centres);
    fuzzy_c_means(points.size(), point, {.iterations = 5}, centres);
    for (int k = 0; k < 4; ++k) EXPECT_EQ(centres[k], points[0]);
}

}  // namespace
}  // namespace crumple
