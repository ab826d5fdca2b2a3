// Features near each other in frames of real scenes, against exact answers from outside, bit by bit.

#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <variant>

#include "crumple/io.h"
#include "io/files.h"
#include "questions/near/asked.h"

namespace crumple {
namespace {

namespace fs = std::filesystem;

struct Frame {
    std::string answer, mesh;  ///< names of files
    double radius;
    int every;  ///< how many lines of the answer stand for one that rational arithmetic is asked
    std::size_t lines, touching;
    friend std::ostream& operator<<(std::ostream& out, const Frame& frame) { return out << frame.answer; }
};

class Mesh {
   public:
    explicit Mesh(const fs::path& file) : mesh_(io::read_mesh(file, {.precision = io::Precision::float64})) {}

    Vec3d vertex(std::int32_t i) const {
        const auto& xyz = std::get<std::vector<double>>(mesh_.vertices);
        const auto at = 3 * static_cast<std::size_t>(i);
        return {xyz.at(at), xyz.at(at + 1), xyz.at(at + 2)};
    }
    Vec3d corner(std::int32_t face, std::size_t i) const {
        return vertex(mesh_.triangles.at(3 * static_cast<std::size_t>(face) + i));
    }

   private:
    io::TriangleMesh mesh_;
};

class DistanceTruth : public testing::TestWithParam<Frame> {};

TEST_P(DistanceTruth, IsFoundToTheLastBit) {
    const auto folder = io::test::data_folder();
    if (!folder) GTEST_SKIP() << "no scenes: set CRUMPLE_DATA";
    const Frame& frame = GetParam();
    if (!fs::exists(*folder / "gt-motion" / frame.answer)) GTEST_SKIP() << "no answers for features that are near";
    const Mesh mesh(*folder / "scalable-ccd" / frame.mesh);

    std::ifstream file(*folder / "gt-motion" / frame.answer);
    std::size_t lines = 0, touching = 0;
    std::string kinds;
    for (; file >> kinds; ++lines) {
        std::array<std::int32_t, 4> id{};
        const bool face = kinds == "vf";
        for (std::size_t i = 0; i < (face ? 2U : 4U); ++i) file >> id[i];
        double squared = 0;
        file >> squared;
        ASSERT_TRUE(file) << "line " << lines;
        touching += squared == 0;
        if (lines % static_cast<std::size_t>(frame.every) != 0) continue;
        const Features features =
            face ? vertex_face(mesh.vertex(id[0]), mesh.corner(id[1], 0), mesh.corner(id[1], 1), mesh.corner(id[1], 2))
                 : edge_edge(mesh.vertex(id[0]), mesh.vertex(id[1]), mesh.vertex(id[2]), mesh.vertex(id[3]));
        const RationalDistance distance(features);
        ASSERT_EQ(distance.squared(), squared) << "line " << lines << ": " << features;
        ASSERT_EQ(distance.touching(), squared == 0) << features;
        ASSERT_TRUE(distance.within({frame.radius, 0, true})) << features;
    }
    EXPECT_EQ(lines, frame.lines);
    EXPECT_EQ(touching, frame.touching);
}

INSTANTIATE_TEST_SUITE_P(GroundTruth, DistanceTruth,
                         testing::Values(Frame{"prox_cloth-funnel_227.txt", "cloth-funnel/frames/227.ply",
                                               0.0047773383557796478, 1, 23'483, 0},
                                         Frame{"prox_cloth-ball_92.txt", "cloth-ball/frames/cloth_ball92.ply",
                                               0.054098617285490036, 1, 727'210, 0},
                                         Frame{"prox_n-body_18.txt", "n-body-simulation/frames/balls16_18.ply",
                                               0.020874753594398499, 1, 98'012, 3'520}),
                         [](const auto& info) {
                             std::string name = info.param.answer.substr(0, info.param.answer.find('.'));
                             for (char& c : name) c = c == '-' ? '_' : c;
                             return name;
                         });

}  // namespace
}  // namespace crumple
