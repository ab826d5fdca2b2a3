// Compares the overlap of two surfaces bit by bit with exact results of external origin.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "crumple/crumple.h"
#include "crumple/io.h"
#include "exact/overlap/rational_sum.h"
#include "io/files.h"

namespace crumple {
namespace {

using Json = nlohmann::json;

Json truth_of(const char* file) {
    const auto folder = io::test::data_folder();
    if (!folder || !std::filesystem::exists(*folder / "gt-overlap" / file)) return nullptr;
    return Json::parse(std::ifstream(*folder / "gt-overlap" / file));
}
Json cases_of(const char* file) {
    const Json truth = truth_of(file);
    return truth.is_null() ? truth : truth.at("cases");
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

    FaceCorners corners(std::size_t face) const {
        FaceCorners p;
        for (std::size_t k = 0; k < 3; ++k) {
            const double* const v = xyz.data() + 3 * triangles[3 * face + k];
            p[k] = {v[0], v[1], v[2]};
        }
        return p;
    }
    MeshView view() const {
        return {xyz.data(), static_cast<std::int64_t>(xyz.size() / 3), triangles.data(),
                static_cast<std::int64_t>(triangles.size() / 3)};
    }
};

void read(const Json& mesh, Surface& surface) {
    for (const Json& p : mesh.at("vertices"))
        for (const Json& x : p) surface.xyz.push_back(from_hexadecimal(x));
    for (const Json& face : mesh.at("faces"))
        for (const Json& v : face) surface.triangles.push_back(v.get<std::int32_t>());
}

void load(const Json& mesh, Surface& surface) {
    const io::ReadOptions options{.precision = io::Precision::float64,
                                  .weld = mesh.value("weld", false) ? io::Weld::yes : io::Weld::no};
    const io::TriangleMesh file = io::read_mesh(*io::test::data_folder() / mesh.at("file").get<std::string>(), options);
    surface.xyz = std::get<std::vector<double>>(file.vertices);
    surface.triangles.assign(file.triangles.begin(), file.triangles.end());
    const double scale = mesh.value("scale", 1.0);
    const std::vector<double> shift = mesh.value("shift", std::vector<double>(3));
    for (std::size_t i = 0; i < surface.xyz.size(); ++i) surface.xyz[i] = surface.xyz[i] * scale + shift[i % 3];
}

/// Numbers of the only row, or of an empty overlap if there is no row.
struct Found {
    double volume = 0, mean_depth = std::nan("");
    std::array<double, 3> centroid{}, area_vector{}, normal{}, torque{}, torque_point{};
    bool in_rationals = false;
    std::array<std::map<std::int32_t, std::array<double, 3>>, 2> gradient;  ///< nonzero derivatives, by vertex
    std::array<std::map<std::int32_t, std::int32_t>, 2> windings;
};

Found overlap_of(const Surface& a, const Surface& b) {
    Detector detector;
    const Overlaps& overlaps = detector.find({a.view(), b.view()}, OverlapQuery{.gradient = true, .windings = true});
    Found found;
    found.centroid.fill(std::nan(""));
    found.normal.fill(std::nan(""));
    found.in_rationals = overlaps.statistics.rational_tests > 0;
    if (overlaps.count == 0) return found;
    found.volume = overlaps.volume[0];
    found.mean_depth = overlaps.mean_depth[0];
    found.centroid = overlaps.centroid[0];
    found.area_vector = overlaps.area_vector[0];
    found.normal = overlaps.normal[0];
    found.torque = overlaps.torque[0];
    found.torque_point = overlaps.torque_point[0];
    for (std::size_t i = 0; i < overlaps.gradient.size(); ++i) {
        const auto [body, vertex] = overlaps.gradient_vertices[i];
        found.gradient[static_cast<std::size_t>(body)][vertex] = overlaps.gradient[i];
    }
    for (std::size_t i = 0; i < overlaps.windings.size(); ++i) {
        const auto [body, vertex] = overlaps.winding_vertices[i];
        found.windings[static_cast<std::size_t>(body)][vertex] = overlaps.windings[i];
    }
    return found;
}

void expect_windings(const std::map<std::int32_t, std::int32_t>& found, const Json& expected, const std::string& what) {
    for (std::size_t v = 0; v < expected.size(); ++v) {
        const auto at = found.find(static_cast<std::int32_t>(v));
        EXPECT_EQ(at == found.end() ? 0 : at->second, expected[v].get<std::int32_t>()) << what << ", vertex " << v;
    }
}

void expect_gradient(const std::map<std::int32_t, std::array<double, 3>>& found, const Json& expected,
                     const std::string& what) {
    for (std::size_t v = 0; v < expected.size(); ++v) {
        const auto at = found.find(static_cast<std::int32_t>(v));
        for (std::size_t k = 0; k < 3; ++k)
            EXPECT_EQ(at == found.end() ? 0 : at->second[k], from_hexadecimal(expected[v][k]))
                << what << ", vertex " << v;
    }
}

void expect_near(double found, const Rational& exact, const std::string& what) {
    const double expected = rounded(exact), unit = std::ldexp(std::abs(expected), -52);
    EXPECT_LE(std::abs(found - expected), 2 * unit) << what;
}

TEST(OverlapTruth, small_cases_have_exact_volumes_and_area_vectors_rounded_once) {
    const Json cases = cases_of("small.json");
    if (cases.is_null()) GTEST_SKIP() << "no exact results";
    std::int64_t rational = 0;
    int compared = 0, gradients = 0;
    for (const Json& c : cases) {
        if (c.at("B").is_null()) continue;
        const std::string name = c.at("name");
        Surface a, b;
        read(c.at("A"), a);
        read(c.at("B"), b);
        const Found found = overlap_of(a, b);
        rational += found.in_rationals;
        EXPECT_EQ(found.volume, from_hexadecimal(c.at("volume_float64"))) << name;
        ++compared;
        std::array<Rational, 3> area, torque, point;
        for (std::size_t k = 0; k < 3; ++k) {
            area[k] = fraction(c.at("area_vector_of_A_mean")[k]);
            torque[k] = fraction(c.at("torque_about_origin_mean")[k]);
            point[k] = Rational(found.torque_point[k]);
        }
        const Rational volume = fraction(c.at("volume"));
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
            EXPECT_EQ(found.area_vector[k], rounded(area[k])) << name;
            EXPECT_EQ(found.torque[k], rounded(torque[k] - (point[i] * area[j] - point[j] * area[i]))) << name;
            if (volume != 0) {
                expect_near(found.centroid[k], fraction(c.at("first_moment")[k]) / volume, name);
            } else {
                EXPECT_TRUE(std::isnan(found.centroid[k])) << name;
            }
        }
        expect_windings(found.windings[0], c.at("winding_of_B_at_A"), name);
        expect_windings(found.windings[1], c.at("winding_of_A_at_B"), name);
        if (c.contains("gradient_of_A_mean_float64")) {
            expect_gradient(found.gradient[0], c.at("gradient_of_A_mean_float64"), name);
            expect_gradient(found.gradient[1], c.at("gradient_of_B_mean_float64"), name);
            ++gradients;
        }
        const Rational square = area[0] * area[0] + area[1] * area[1] + area[2] * area[2];
        if (square == 0) {
            EXPECT_TRUE(std::isnan(found.mean_depth) && std::isnan(found.normal[0])) << name;
        } else {
            const double depth = std::sqrt(rounded(volume * volume / square));
            if (depth > 0 && std::isfinite(depth)) {
                EXPECT_NEAR(std::abs(found.mean_depth), depth, 4e-16 * depth) << name;
            }
            EXPECT_NEAR(std::hypot(found.normal[0], found.normal[1], found.normal[2]), 1, 1e-15) << name;
        }
    }
    EXPECT_GE(compared, 40);
    EXPECT_GE(gradients, 12);
    EXPECT_LT(rational, 2 * compared / 3) << "words decide all sums of many cases";
}

TEST(OverlapTruth, crossing_faces_are_those_of_the_ground_truth) {
    const Json cases = cases_of("small.json");
    if (cases.is_null()) GTEST_SKIP() << "the shared data is not here";
    int compared = 0;
    for (const Json& c : cases) {
        if (!c.contains("crossing_pairs") || c.at("B").is_null()) continue;
        Surface a, b;
        read(c.at("A"), a);
        read(c.at("B"), b);
        std::vector<std::array<int, 2>> found;
        for (std::size_t f = 0; 3 * f < a.triangles.size(); ++f)
            for (std::size_t g = 0; 3 * g < b.triangles.size(); ++g)
                if (decide_crossings(a.corners(f), b.corners(g)).forward.jumps.segment)
                    found.push_back({static_cast<int>(f), static_cast<int>(g)});
        auto expected = c.at("crossing_pairs").get<std::vector<std::array<int, 2>>>();
        std::sort(expected.begin(), expected.end());
        EXPECT_EQ(found, expected) << c.at("name");
        ++compared;
    }
    EXPECT_GE(compared, 40);
}

/// Expects the exact number of curves and of regions, as many segments as pairs that cross, and the exact volumes of
/// regions, as far as they are known.
void expect_curves(const Surface& a, const Surface& b, const Json& c) {
    const std::string name = c.at("name");
    Detector detector;
    const Overlaps& found = detector.find({a.view(), b.view()}, OverlapQuery{.curves = true, .regions = true});
    EXPECT_EQ(found.curve_closed.size(), c.at("curves").get<std::size_t>()) << name;
    ASSERT_EQ(found.region_volume.size(), c.at("regions").get<std::size_t>()) << name;
    std::vector<double> volumes(found.region_volume.begin(), found.region_volume.end());
    std::sort(volumes.begin(), volumes.end(), std::greater<>());
    const bool exact = c.contains("region_volumes_float64");
    const Json& expected = c.at(exact ? "region_volumes_float64" : "region_volumes");
    for (std::size_t r = 0; r < volumes.size(); ++r) {
        const double volume = exact ? from_hexadecimal(expected[r]) : expected[r].get<double>();
        EXPECT_NEAR(volumes[r], volume, exact ? 0 : 1e-13 * volumes[0]) << name;
    }
    std::int64_t segments = 0;
    for (std::size_t j = 0; j < found.curve_closed.size(); ++j) {
        EXPECT_EQ(found.curve_closed[j], 1) << name;
        const std::int64_t first = found.curve_point_offsets[j], last = found.curve_point_offsets[j + 1] - 1;
        EXPECT_EQ(found.curve_points[first], found.curve_points[last]) << name;
        segments += last - first;
    }
    const Json& pairs = c.at("crossing_pairs");
    EXPECT_EQ(segments, pairs.is_array() ? std::ssize(pairs) : pairs.get<std::int64_t>()) << name;
}

TEST(OverlapTruth, curves_and_segments_have_the_exact_counts) {
    int compared = 0;
    for (const char* const file : {"small.json", "large.json"}) {
        const Json cases = cases_of(file);
        if (cases.is_null()) GTEST_SKIP() << "no exact results";
        for (const Json& c : cases) {
            if (!c.contains("curves") || c.at("curves").is_null() || c.at("B").is_null()) continue;
            Surface a, b;
            for (const auto& [side, surface] : {std::pair("A", &a), std::pair("B", &b)})
                c.at(side).contains("file") ? load(c.at(side), *surface) : read(c.at(side), *surface);
            expect_curves(a, b, c);
            ++compared;
        }
    }
    EXPECT_GE(compared, 11);
}

TEST(OverlapTruth, overlaps_of_balls_in_a_scene_have_exact_volumes_rounded_once) {
    const Json truth = truth_of("balls16_18.json");
    if (truth.is_null()) GTEST_SKIP() << "no exact results";
    const std::filesystem::path file = *io::test::data_folder() / truth.at("file").get<std::string>();
    const Json runs = Json::parse(std::ifstream(file.parent_path().parent_path().parent_path() / "derived" /
                                                "n-body-simulation_components.json"));
    Surface scene;
    load({{"file", truth.at("file")}}, scene);
    const auto part_of = [&](const char* name, std::size_t body, std::size_t end) {
        const Json& starts = runs.at(name);
        const auto at = [&](std::size_t b) { return b < starts.size() ? starts[b][1].get<std::size_t>() : end; };
        return std::pair(at(body), at(body + 1));
    };
    const auto body = [&](std::size_t b) {
        const auto [v, v_end] = part_of("vertex_runs", b, scene.xyz.size() / 3);
        const auto [t, t_end] = part_of("triangle_runs", b, scene.triangles.size() / 3);
        Surface surface{{&scene.xyz[3 * v], &scene.xyz[0] + 3 * v_end},
                        {&scene.triangles[3 * t], &scene.triangles[0] + 3 * t_end}};
        for (std::int32_t& vertex : surface.triangles) vertex -= static_cast<std::int32_t>(v);
        return surface;
    };
    for (const Json& row : truth.at("rows")) {
        const Surface a = body(row[0].get<std::size_t>()), b = body(row[1].get<std::size_t>());
        EXPECT_EQ(overlap_of(a, b).volume, from_hexadecimal(row[2])) << row[0] << ' ' << row[1];
    }
    EXPECT_EQ(truth.at("rows").size(), 37u);
}

TEST(OverlapTruth, self_overlaps_have_exact_volumes) {
    const Json cases = cases_of("small.json");
    if (cases.is_null()) GTEST_SKIP() << "no exact results";
    int compared = 0;
    for (const Json& c : cases) {
        if (!c.at("B").is_null()) continue;
        const std::string name = c.at("name");
        Surface surface;
        read(c.at("A"), surface);
        Detector detector;
        const Overlaps& found = detector.find(surface.view(), OverlapQuery{.windings = true});
        const double expected = from_hexadecimal(c.at("self_overlap_float64"));
        EXPECT_EQ(found.count == 0 ? 0 : found.volume[0], expected) << name;
        EXPECT_EQ(found.body_volume[0], rounded(fraction(c.at("signed_volume")))) << name;
        EXPECT_EQ(found.is_solid[0] != 0, expected == 0) << name;
        std::map<std::int32_t, std::int32_t> windings;
        for (std::size_t i = 0; i < found.windings.size(); ++i)
            windings[found.winding_vertices[i].vertex] = found.windings[i];
        if (found.count) expect_windings(windings, c.at("winding_of_B_at_A"), name);
        ++compared;
    }
    EXPECT_GE(compared, 3);
}

TEST(OverlapTruth, overlaps_of_real_meshes_have_exact_volumes_rounded_once) {
    const Json cases = cases_of("large.json");
    if (cases.is_null()) GTEST_SKIP() << "no exact results";
    int compared = 0;
    for (const Json& c : cases) {
        if (c.at("B").is_null()) continue;
        Surface a, b;
        load(c.at("A"), a);
        load(c.at("B"), b);
        const Found found = overlap_of(a, b);
        EXPECT_EQ(found.volume, from_hexadecimal(c.at("volume_float64"))) << c.at("name");
        ++compared;
    }
    EXPECT_GT(compared, 4);
}

TEST(OverlapTruth, exchanged_surfaces_have_opposite_area_vectors) {
    const Json cases = cases_of("small.json");
    if (cases.is_null()) GTEST_SKIP() << "no exact results";
    for (const Json& c : cases) {
        if (c.at("B").is_null()) continue;
        Surface a, b;
        read(c.at("A"), a);
        read(c.at("B"), b);
        const Found one = overlap_of(a, b), other = overlap_of(b, a);
        const std::string name = c.at("name");
        EXPECT_EQ(one.volume, other.volume) << name;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            EXPECT_EQ(one.area_vector[axis], -other.area_vector[axis]) << name;
            EXPECT_EQ(one.torque[axis], -other.torque[axis]) << name;
            if (one.volume != 0) {
                EXPECT_EQ(one.centroid[axis], other.centroid[axis]) << name;
            }
        }
    }
}

}  // namespace
}  // namespace crumple
