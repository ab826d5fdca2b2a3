// The overlap of two surfaces against exact results from outside, bit by bit.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <variant>

#include <nlohmann/json.hpp>

#include "base/float_environment.h"
#include "crumple/crumple.h"
#include "crumple/io.h"
#include "exact/overlap/rational_sum.h"
#include "io/files.h"
#include "search/overlap_row.h"

namespace crumple {
namespace {

using Json = nlohmann::json;

Json cases_of(const char* file) {
    const auto folder = io::test::data_folder();
    if (!folder || !std::filesystem::exists(*folder / "gt-overlap" / file)) return nullptr;
    return Json::parse(std::ifstream(*folder / "gt-overlap" / file)).at("cases");
}

double from_hexadecimal(const Json& text) { return std::strtod(text.get<std::string>().c_str(), nullptr); }
Rational fraction(const Json& text) { return Rational(text.get<std::string>()); }
double rounded(const Rational& x) {
    Cancellation none;
    RationalSum sum;
    sum.add(x);
    return sum.rounded_quotient(1, none).value;
}

struct Surface {
    std::vector<double> xyz;
    std::vector<std::int32_t> triangles;
    std::vector<Vec3d> points;
    ClosedSurface topology{nullptr};

    /// Vertices are scaled, then shifted.
    void finish(double scale = 1, const Vec3d& shift = {}) {
        for (std::size_t i = 0; i < xyz.size(); ++i) xyz[i] = xyz[i] * scale + shift[static_cast<int>(i % 3)];
        for (std::size_t i = 0; i < xyz.size(); i += 3) points.push_back({xyz[i], xyz[i + 1], xyz[i + 2]});
        ParallelFor workers;
        SceneBuffers buffers;
        topology.prepare(prepare_scene(view(), nullptr, false, workers, buffers), workers);
    }
    MeshView view() const {
        return {xyz.data(), static_cast<std::int64_t>(xyz.size() / 3), triangles.data(),
                static_cast<std::int64_t>(triangles.size() / 3)};
    }
    PlacedSurface placed() const {
        PlacedSurface placed{&topology, points.data()};
        for (const Vec3d& p : points) placed.box.widen(p);
        for (const double x : xyz) placed.in_range &= x == 0 || (std::abs(x) >= 0x1p-150 && std::abs(x) <= 0x1p150);
        return placed;
    }
};

void read(const Json& mesh, Surface& surface) {
    for (const Json& p : mesh.at("vertices"))
        for (const Json& x : p) surface.xyz.push_back(from_hexadecimal(x));
    for (const Json& face : mesh.at("faces"))
        for (const Json& v : face) surface.triangles.push_back(v.get<std::int32_t>());
    surface.finish();
}

void load(const Json& mesh, Surface& surface) {
    const io::ReadOptions options{.precision = io::Precision::float64,
                                  .weld = mesh.value("weld", false) ? io::Weld::yes : io::Weld::no};
    const io::TriangleMesh file = io::read_mesh(*io::test::data_folder() / mesh.at("file").get<std::string>(), options);
    surface.xyz = std::get<std::vector<double>>(file.vertices);
    surface.triangles.assign(file.triangles.begin(), file.triangles.end());
    Vec3d shift{};
    for (int axis = 0; axis < 3 && mesh.contains("shift"); ++axis)
        shift[axis] = mesh["shift"][static_cast<std::size_t>(axis)];
    surface.finish(mesh.value("scale", 1.0), shift);
}

OverlapNumbers overlap_of(const Surface& a, const Surface& b, std::int64_t* rational_rows = nullptr) {
    const FloatEnvironment environment;
    Detector detector;
    const Intersections& found = detector.find({a.view(), b.view()});
    const PlacedSurface placed_a = a.placed(), placed_b = b.placed();
    Vec3d origin{};
    for (int axis = 0; axis < 3; ++axis)
        origin[axis] = 0.5 * std::max(placed_a.box.low[axis], placed_b.box.low[axis]) +
                       0.5 * std::min(placed_a.box.high[axis], placed_b.box.high[axis]);
    Cancellation none;
    OverlapOfBodies overlap(none);
    const OverlapNumbers numbers = overlap.find(placed_a, placed_b, {found.pairs.data(), found.pairs.size()}, origin);
    if (rational_rows) *rational_rows += overlap.rational_rows();
    return numbers;
}

void expect_near(double found, const Rational& exact, const std::string& what) {
    const double expected = rounded(exact), unit = std::ldexp(std::abs(expected), -52);
    EXPECT_LE(std::abs(found - expected), 2 * unit) << what;
}

TEST(OverlapTruth, SmallCasesHaveTheExactNumbersRoundedOnce) {
    const Json cases = cases_of("small.json");
    if (cases.is_null()) GTEST_SKIP() << "no exact results";
    std::int64_t rational = 0;
    int compared = 0;
    for (const Json& c : cases) {
        if (c.at("B").is_null()) continue;
        const std::string name = c.at("name");
        Surface a, b;
        read(c.at("A"), a);
        read(c.at("B"), b);
        ASSERT_TRUE(a.topology.closed() && b.topology.closed()) << name;
        const OverlapNumbers found = overlap_of(a, b, &rational);
        EXPECT_EQ(found.volume.value, from_hexadecimal(c.at("volume_float64"))) << name;
        ++compared;
        std::array<Rational, 3> area, torque, point;
        for (std::size_t k = 0; k < 3; ++k) {
            area[k] = fraction(c.at("area_vector_of_A_mean")[k]);
            torque[k] = fraction(c.at("torque_about_origin_mean")[k]);
            point[k] = Rational(found.point[static_cast<int>(k)]);
        }
        const Rational volume = fraction(c.at("volume"));
        for (std::size_t k = 0; k < 3; ++k) {
            const int axis = static_cast<int>(k);
            const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
            EXPECT_EQ(found.area_vector[axis], rounded(area[k])) << name;
            EXPECT_EQ(found.torque[axis], rounded(torque[k] - (point[i] * area[j] - point[j] * area[i]))) << name;
            if (volume != 0) {
                expect_near(found.centroid[axis], fraction(c.at("first_moment")[k]) / volume, name);
            } else {
                EXPECT_TRUE(std::isnan(found.centroid[axis])) << name;
            }
        }
        const Rational square = area[0] * area[0] + area[1] * area[1] + area[2] * area[2];
        if (square == 0) {
            EXPECT_TRUE(std::isnan(found.mean_depth) && std::isnan(found.normal.x)) << name;
        } else {
            const double depth = std::sqrt(rounded(volume * volume / square));
            if (depth > 0 && std::isfinite(depth)) {
                EXPECT_NEAR(std::abs(found.mean_depth), depth, 4e-16 * depth) << name;
            }
            EXPECT_NEAR(dot(found.normal, found.normal), 1, 1e-15) << name;
        }
    }
    EXPECT_GE(compared, 40);
    EXPECT_LT(rational, compared / 2) << "double words decide most cases";
}

TEST(OverlapTruth, RealMeshesHaveTheExactVolumeRoundedOnce) {
    const Json cases = cases_of("large.json");
    if (cases.is_null()) GTEST_SKIP() << "no exact results";
    int compared = 0;
    for (const Json& c : cases) {
        if (c.at("B").is_null()) continue;
        Surface a, b;
        load(c.at("A"), a);
        load(c.at("B"), b);
        const OverlapNumbers found = overlap_of(a, b);
        EXPECT_EQ(found.volume.value, from_hexadecimal(c.at("volume_float64"))) << c.at("name");
        ++compared;
    }
    EXPECT_GT(compared, 4);
}

TEST(OverlapTruth, ExchangedSurfacesHaveTheSameVolumeAndOppositeAreaVectors) {
    const Json cases = cases_of("small.json");
    if (cases.is_null()) GTEST_SKIP() << "no exact results";
    for (const Json& c : cases) {
        if (c.at("B").is_null()) continue;
        Surface a, b;
        read(c.at("A"), a);
        read(c.at("B"), b);
        const OverlapNumbers one = overlap_of(a, b), other = overlap_of(b, a);
        const std::string name = c.at("name");
        EXPECT_EQ(one.volume.value, other.volume.value) << name;
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_EQ(one.area_vector[axis], -other.area_vector[axis]) << name;
            EXPECT_EQ(one.torque[axis], -other.torque[axis]) << name;
            if (one.volume.value != 0) {
                EXPECT_EQ(one.centroid[axis], other.centroid[axis]) << name;
            }
        }
    }
}

}  // namespace
}  // namespace crumple
