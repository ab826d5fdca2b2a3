// Checks the promises of every scene: the requested number of triangles, sound arrays, the same bits on every machine.

#include "scenes/scenes.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>

#include "crumple/error.h"
#include "scenes/cloth.h"

namespace crumple {
namespace {

using scenes::Description;
using scenes::make;

std::vector<double> coordinates(const io::TriangleMesh& mesh) {
    return std::visit([](const auto& v) { return std::vector<double>(v.begin(), v.end()); }, mesh.vertices);
}

/// Returns a hash of everything in the mesh, coordinates by their bits.
std::uint64_t fingerprint(const io::TriangleMesh& mesh) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    const auto add = [&](std::uint64_t value) { hash = std::rotl((hash ^ value) * 0x100000001b3u, 29); };
    for (const double x : coordinates(mesh)) add(std::bit_cast<std::uint64_t>(x));
    for (const std::int32_t i : mesh.triangles) add(static_cast<std::uint32_t>(i));
    for (const std::int32_t g : mesh.groups) add(static_cast<std::uint32_t>(g));
    return hash;
}

std::string message(std::string_view name, const scenes::Parameters& parameters) {
    try {
        make(name, parameters);
    } catch (const Error& error) {
        EXPECT_EQ(error.code, ErrorCode::invalid_argument);
        return error.what();
    }
    return "no error";
}

/// Keeps simulated frames away from the user's cache.
class OwnCache : public testing::Environment {
   public:
    void SetUp() override {
        std::string name = (std::filesystem::temp_directory_path() / "crumple-scenes-XXXXXX").string();
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        folder_ = name;
        setenv("XDG_CACHE_HOME", name.c_str(), 1);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

   private:
    std::filesystem::path folder_;
};
const testing::Environment* const own_cache = testing::AddGlobalTestEnvironment(new OwnCache);

/// Returns the last frame of a scene or, for simulated scenes, a frame early enough for a short test.
int late_frame(const Description& scene, std::int64_t triangles) {
    if (!scene.simulated) return scene.frames - 1;
    return triangles > 1000 ? 2 : scene.frames / 3;
}

class EveryScene : public testing::TestWithParam<Description> {};

INSTANTIATE_TEST_SUITE_P(Scenes, EveryScene,
                         testing::ValuesIn(scenes::descriptions().begin(), scenes::descriptions().end()),
                         [](const auto& scene) { return std::string(scene.param.name); });

TEST_P(EveryScene, has_about_the_requested_number_of_triangles) {
    for (const std::int64_t requested : {std::int64_t{0}, std::int64_t{10'000}, std::int64_t{31'415}}) {
        const std::int64_t expected = requested ? requested : GetParam().triangles;
        const std::int64_t count = make(GetParam().name, {.triangles = requested}).triangle_count();
        EXPECT_NEAR(static_cast<double>(count), static_cast<double>(expected), 0.1 * static_cast<double>(expected));
    }
}

TEST_P(EveryScene, has_finite_vertices_and_valid_indices_even_for_one_triangle) {
    for (const std::int64_t triangles : {1, 2, 100, 12'345}) {
        const io::TriangleMesh mesh =
            make(GetParam().name, {.triangles = triangles, .frame = late_frame(GetParam(), triangles)});
        ASSERT_GT(mesh.triangle_count(), 0);
        for (const double x : coordinates(mesh)) ASSERT_TRUE(std::isfinite(x));
        for (const std::int32_t i : mesh.triangles) {
            ASSERT_GE(i, 0);
            ASSERT_LT(i, mesh.vertex_count());
        }
        EXPECT_TRUE(mesh.groups.empty() || mesh.groups.size() == mesh.triangles.size() / 3);
    }
}

TEST_P(EveryScene, has_a_repeatable_frame_0_that_changes_with_the_seed_if_random) {
    const scenes::Parameters parameters{.triangles = 3000};
    EXPECT_EQ(fingerprint(make(GetParam().name, parameters)), fingerprint(make(GetParam().name, parameters)));
    const bool random = GetParam().name != "shells";
    const auto other = fingerprint(make(GetParam().name, {.triangles = 3000, .seed = 2}));
    EXPECT_EQ(fingerprint(make(GetParam().name, parameters)) != other, random);
}

TEST_P(EveryScene, has_different_frames_0_and_1_if_it_is_animated) {
    if (GetParam().frames == 1) return;
    EXPECT_NE(fingerprint(make(GetParam().name, {.triangles = 3000, .frame = 0})),
              fingerprint(make(GetParam().name, {.triangles = 3000, .frame = 1})));
}

TEST(Scenes, have_their_recorded_fingerprints) {
    const std::map<std::string_view, std::uint64_t> expected{
        {"cloth", 0x3a08e3aa1842f07c},         {"ground", 0x2f122dae4f6adf5d},      {"soup", 0x58bdec4a22349908},
        {"needles", 0xeab57c77bc95661f},       {"five_decades", 0x354662ce35d91b5}, {"bodies", 0x9c95738cf745f8d8},
        {"shells", 0xc911d351e28a1fb1},        {"fans", 0xf31074801d3cb54d},        {"lattice", 0xb3bf19f16299d443},
        {"cloth_on_ball", 0xfa902c0ecda19dcf}, {"funnel", 0x618b466af92d1955},      {"cutting", 0xa4c37e56af00eada},
        {"knots", 0xfd61e9b0b5d92a90},         {"model", 0x2341ca804155877c},
    };
    ASSERT_EQ(expected.size(), scenes::descriptions().size());
    for (const Description& scene : scenes::descriptions()) {
        const std::int64_t triangles = scene.simulated ? 1000 : 3000;
        const auto actual =
            fingerprint(make(scene.name, {.triangles = triangles, .frame = late_frame(scene, triangles)}));
        EXPECT_EQ(actual, expected.at(scene.name)) << scene.name << " is 0x" << std::hex << actual;
    }
}

TEST(ClothBlock, blocks_join_to_the_whole_cloth) {
    const scenes::Parameters parameters{.triangles = 3000, .frame = 93};
    const io::TriangleMesh whole = make("cloth", parameters);
    const std::vector<double> xyz = coordinates(whole);
    for (const int blocks : {1, 2, 3, 50}) {
        std::vector<std::int32_t> triangles, groups;
        for (int b = 0; b < blocks; ++b) {
            const auto [mesh, first] = scenes::cloth_block(parameters, b, blocks);
            const std::vector<double> own = coordinates(mesh);
            ASSERT_LE(3 * static_cast<std::size_t>(first) + own.size(), xyz.size());
            EXPECT_TRUE(std::equal(own.begin(), own.end(), xyz.begin() + 3 * first)) << b << " of " << blocks;
            for (const std::int32_t v : mesh.triangles) triangles.push_back(static_cast<std::int32_t>(first) + v);
            groups.insert(groups.end(), mesh.groups.begin(), mesh.groups.end());
        }
        EXPECT_EQ(triangles, whole.triangles) << blocks;
        EXPECT_EQ(groups, whole.groups) << blocks;
    }
}

TEST(Scenes, error_for_an_unknown_name_lists_all_scenes) {
    const std::string text = message("clot", {});
    EXPECT_NE(text.find("no scene clot"), std::string::npos) << text;
    for (const Description& scene : scenes::descriptions()) EXPECT_NE(text.find(scene.name), std::string::npos) << text;
}

TEST(Scenes, wrong_frames_and_triangle_counts_are_rejected) {
    EXPECT_NE(message("cloth", {.frame = 94}).find("0 to 93"), std::string::npos);
    EXPECT_NE(message("cloth", {.frame = -1}).find("no frame -1"), std::string::npos);
    EXPECT_NE(message("soup", {.triangles = -5}).find("-5"), std::string::npos);
    EXPECT_NE(message("soup", {.triangles = 1'000'000'000}).find("500000000"), std::string::npos);
}

/// Expects every directed edge once, and its opposite once: a closed and consistently oriented surface.
void expect_closed(std::string_view name) {
    const io::TriangleMesh mesh = make(name, {.triangles = 5000});
    std::map<std::pair<std::int32_t, std::int32_t>, int> edges;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const std::size_t next = i % 3 == 2 ? i - 2 : i + 1;
        ++edges[{mesh.triangles[i], mesh.triangles[next]}];
    }
    for (const auto& [edge, count] : edges) {
        const auto opposite = edges.find({edge.second, edge.first});
        ASSERT_TRUE(count == 1 && opposite != edges.end()) << name << ": edge " << edge.first << ", " << edge.second;
    }
}

TEST(Scenes, bodies_are_closed_surfaces) {
    for (const char* name : {"bodies", "shells", "fans", "knots"}) expect_closed(name);
}

TEST(Scenes, bodies_have_positive_signed_volumes) {
    for (const char* name : {"bodies", "shells", "fans", "knots"}) {
        const io::TriangleMesh mesh = make(name, {.triangles = 5000});
        const auto xyz = coordinates(mesh);
        std::map<std::int32_t, double> volumes;  // by body: six times its signed volume
        for (std::size_t t = 0; t < mesh.groups.size(); ++t) {
            const double* p[3];
            for (std::size_t k = 0; k < 3; ++k) p[k] = &xyz[3 * static_cast<std::size_t>(mesh.triangles[3 * t + k])];
            volumes[mesh.groups[t]] += p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) +
                                       p[0][1] * (p[1][2] * p[2][0] - p[1][0] * p[2][2]) +
                                       p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
        }
        for (const auto& [body, volume] : volumes) EXPECT_GT(volume, 0) << name << ", body " << body;
    }
}

TEST(Scenes, lattice_is_in_float64_with_large_integer_coordinates) {
    for (const double x : coordinates(make("lattice"))) {
        ASSERT_EQ(x, std::floor(x));
        ASSERT_GE(x, 0x1p28);
    }
    EXPECT_EQ(make("lattice").precision(), ScalarType::float64);
    EXPECT_EQ(make("cloth").precision(), ScalarType::float32);
}

}  // namespace
}  // namespace crumple
