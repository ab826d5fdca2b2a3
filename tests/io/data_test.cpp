// Checks that the real scenes can be read and have the sizes that their README states.

#include <algorithm>

#include "files.h"

namespace crumple::io::test {
namespace {

struct Scene {
    const char* path;
    std::int64_t vertices, triangles;  ///< numbers in the README; vertices 0: not stated there
    ScalarType precision;
};

class Data : public testing::Test {
   protected:
    void SetUp() override {
        if (!folder) GTEST_SKIP() << "no scenes: set CRUMPLE_DATA";
    }
    std::optional<fs::path> folder = data_folder();
};

TEST_F(Data, scenes_have_the_sizes_stated_in_the_readme) {
    constexpr ScalarType single = ScalarType::float32, twofold = ScalarType::float64;
    const Scene scenes[] = {
        {"scalable-ccd/cloth-ball/frames/cloth_ball92.ply", 46'598, 92'230, single},
        {"scalable-ccd/cloth-ball/frames/cloth_ball93.ply", 46'598, 92'230, single},
        {"scalable-ccd/cloth-funnel/frames/227.ply", 9'450, 18'484, twofold},
        {"scalable-ccd/n-body-simulation/frames/balls16_18.ply", 73'960, 146'480, single},
        {"meshes/Generic_Twin_right.obj", 0, 11'656, twofold},
        {"meshes/turbineblade_199k.ply", 99'519, 199'034, single},
        {"ipc-toolkit-test-data/bunny.ply", 2'503, 5'002, twofold},
    };
    for (const Scene& scene : scenes) {
        SCOPED_TRACE(scene.path);
        const TriangleMesh mesh = read_mesh(*folder / scene.path);
        EXPECT_EQ(mesh.triangle_count(), scene.triangles);
        if (scene.vertices > 0) {
            EXPECT_EQ(mesh.vertex_count(), scene.vertices);
        }
        EXPECT_EQ(mesh.precision(), scene.precision);
    }
}

TEST_F(Data, real_meshes_keep_their_bits_when_written_as_ply) {
    const Folder output;
    int read = 0;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(*folder)) {
        const std::string extension = entry.path().extension().string();
        if (extension != ".ply" && extension != ".obj" && extension != ".stl" && extension != ".off") continue;
        SCOPED_TRACE(entry.path().string());
        const TriangleMesh mesh = read_mesh(entry.path());
        EXPECT_GT(mesh.triangle_count(), 0);
        write_mesh(output / "a.ply", mesh);
        expect_same(read_mesh(output / "a.ply"), mesh);
        ++read;
    }
    EXPECT_GE(read, 30);
}

TEST_F(Data, ground_truth_lists_of_pairs_are_read) {
    const std::vector<Pair> pairs = read_pairs(*folder / "gt/cloth_ball92.txt");
    EXPECT_EQ(pairs.size(), 63'602u);
    EXPECT_TRUE(std::is_sorted(pairs.begin(), pairs.end()));
    EXPECT_TRUE(read_pairs(*folder / "gt/ipc_bunny.txt").empty() == (fs::file_size(*folder / "gt/ipc_bunny.txt") == 0));
}

}  // namespace
}  // namespace crumple::io::test
