// Tests of stars: vertices that many triangles contain, whose pairs are proven apart by sorting arcs of directions.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "soups.h"

namespace crumple {
namespace {

using test::difference;
using test::pairs_of;
using test::Soup;

constexpr int triangles = 140;

struct Shape {
    const char* name;
    bool simple;  // no two triangles collide
    // Direction of rim vertex i, as seen from the centre, in units of the radius.
    std::function<std::array<double, 3>(int i, std::mt19937& random)> rim;
};

double uniform(std::mt19937& random) { return static_cast<double>(random()) * 0x1p-32; }

std::array<double, 3> on_circle(double turns, double height, double radius = 1) {
    const double angle = 2 * std::numbers::pi * turns;
    return {radius * std::cos(angle), radius * std::sin(angle), height};
}

const std::vector<Shape> shapes{
    {"disc", true, [](int i, std::mt19937&) { return on_circle(i / 141.0, 0); }},
    {"cone", true, [](int i, std::mt19937&) { return on_circle(i / 141.0, 0.7); }},
    {"needles", true,
     [](int i, std::mt19937& random) {
         return std::array<double, 3>{0.1 + i * 1e-3, 1e-4 * uniform(random) + 1e-6 * i * i, 1e-4 * uniform(random)};
     }},
    {"spiral", false, [](int i, std::mt19937&) { return on_circle(i / 90.0, 0, 1 + i * 1e-3); }},
    {"helix", false, [](int i, std::mt19937&) { return on_circle(i / 90.0, 1e-3 * i); }},
    {"pleated disc", false, [](int i, std::mt19937&) { return on_circle((i - i % 3 * 2) / 143.0, 0); }},
    {"rough cone", false,
     [](int i, std::mt19937& random) { return on_circle(i / 141.0 + 1e-2 * uniform(random), 0.3 * uniform(random)); }}};

// Returns how two triangles of a star share the ray between them: by an edge; by edges of different vertices; or by an
// edge that is twice as long as the other, whose end is moved by up to one unit in the last place.
enum class Ray { shared, copied, doubled };

// Makes the star of vertex 0.
template <class Scalar>
Soup<Scalar> star(const Shape& shape, double size, const std::array<double, 3>& centre, Ray ray) {
    std::mt19937 random(7);
    Soup<Scalar> soup;
    const auto add = [&](const std::array<double, 3>& from_centre) {
        std::array<Scalar, 3> p;
        for (std::size_t axis = 0; axis < 3; ++axis)
            p[axis] = static_cast<Scalar>(size * (centre[axis] + from_centre[axis]));
        soup.vertices.push_back(p);
        return static_cast<std::int32_t>(soup.vertices.size() - 1);
    };
    add({0, 0, 0});
    std::int32_t last = add(shape.rim(0, random));
    for (int i = 1; i <= triangles; ++i) {
        if (ray != Ray::shared && i > 1) {
            std::array<Scalar, 3> copy = soup.vertices[static_cast<std::size_t>(last)];
            if (ray == Ray::doubled) {
                for (Scalar& x : copy) x *= i % 2 ? Scalar{2} : Scalar{0.5};
                Scalar& moved = copy[random() % 3];
                const auto kind = random() % 3;
                if (kind < 2) moved = std::nextafter(moved, static_cast<Scalar>(kind ? 100 : -100));
            }
            soup.vertices.push_back(copy);
            last = static_cast<std::int32_t>(soup.vertices.size() - 1);
        }
        const std::int32_t next = add(shape.rim(i, random));
        soup.triangles.push_back({0, last, next});
        last = next;
    }
    return soup;
}

template <class Scalar>
void expect_reference(const Soup<Scalar>& soup, const std::string& what, bool is_star_used) {
    for (const IntersectionKind kind : {IntersectionKind::all, IntersectionKind::proper}) {
        if (kind == IntersectionKind::proper && sizeof(Scalar) == 8) continue;  // saves time
        const IntersectionQuery query{.kind = kind};
        Detector reference({.backend = Backend::reference});
        const auto expected = pairs_of(reference.find(soup.view(), query));
        for (const Simd simd : {Simd::automatic, Simd::scalar}) {
            Detector detector({.backend = Backend::cpu, .threads = 1, .simd = simd});
            const Intersections& found = detector.find(soup.view(), query);
            EXPECT_EQ(difference(expected, pairs_of(found)), "") << what;
            if (is_star_used) {
                EXPECT_LT(found.statistics.box_overlaps, 10 * triangles) << what;
            }
        }
    }
}

TEST(VertexStars, pairs_of_a_star_match_brute_force) {
    for (const Shape& shape : shapes) {
        expect_reference(star<float>(shape, 1, {0, 0, 0}, Ray::shared), shape.name, shape.simple);
        expect_reference(star<double>(shape, 1e6, {3, 5, 7}, Ray::shared), shape.name, shape.simple);
        expect_reference(star<double>(shape, 1e-9, {0, 0, 0}, Ray::copied), shape.name, shape.simple);
    }
}

TEST(VertexStars, rays_that_coincide_up_to_one_unit_in_the_last_place_match_brute_force) {
    for (const Shape& shape : shapes) {
        expect_reference(star<float>(shape, 1, {0, 0, 0}, Ray::doubled), shape.name, shape.simple);
        expect_reference(star<double>(shape, 1, {0, 0, 0}, Ray::doubled), shape.name, shape.simple);
    }
}

// Two stars with common triangles, so that some pairs are in both.
TEST(VertexStars, triangles_of_two_stars_match_brute_force) {
    Soup<float> soup;
    soup.vertices = {{0, 0, -1}, {0, 0, 1}};
    for (int i = 0; i < triangles; ++i) {
        const auto p = on_circle(i % 90 / 90.0, 0, 1 + 1e-3 * i);
        soup.vertices.push_back({static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
        soup.triangles.push_back({0, 1, i + 2});
    }
    expect_reference(soup, "book", false);
}

}  // namespace
}  // namespace crumple
