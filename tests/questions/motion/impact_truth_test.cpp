// Impacts between frames of real scenes, against exact answers from outside, bit by bit.

#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <variant>

#include "crumple/io.h"
#include "io/files.h"
#include "questions/motion/moves.h"

namespace crumple {
namespace {

namespace fs = std::filesystem;

struct Step {
    std::string answer, start, end;  ///< names of files
    int every;                       ///< how many lines of the answer stand for one that is asked
    std::size_t asked;
    friend std::ostream& operator<<(std::ostream& out, const Step& step) { return out << step.answer; }
};

/// Vertices at the start and at the end, and faces.
struct Frames {
    io::TriangleMesh start, end;

    MovingPoint vertex(std::int32_t i) const { return {position(start, i), position(end, i)}; }
    MovingPoint corner(std::int32_t face, std::size_t i) const {
        return vertex(start.triangles[3 * static_cast<std::size_t>(face) + i]);
    }

   private:
    static Vec3d position(const io::TriangleMesh& mesh, std::int32_t vertex) {
        const auto at = 3 * static_cast<std::size_t>(vertex);
        const auto& xyz = std::get<std::vector<double>>(mesh.vertices);
        return {xyz.at(at), xyz.at(at + 1), xyz.at(at + 2)};
    }
};

class ImpactTruth : public testing::TestWithParam<Step> {};

TEST_P(ImpactTruth, IsFoundToTheLastBit) {
    const auto folder = io::test::data_folder();
    if (!folder) GTEST_SKIP() << "no scenes: set CRUMPLE_DATA";
    const Step& step = GetParam();
    if (!fs::exists(*folder / "gt-motion" / step.answer)) GTEST_SKIP() << "no answers for moving scenes";
    const auto frame = [&](const std::string& name) {
        return io::read_mesh(*folder / "scalable-ccd" / name, {.precision = io::Precision::float64});
    };
    const Frames frames{frame(step.start), frame(step.end)};
    ASSERT_EQ(frames.start.triangles, frames.end.triangles);

    std::ifstream file(*folder / "gt-motion" / step.answer);
    std::size_t asked = 0;
    std::string kind;
    for (int line = 0; file >> kind; ++line) {
        std::array<std::int32_t, 4> id{};
        const bool face = kind == "vf";
        for (std::size_t i = 0; i < (face ? 2U : 4U); ++i) file >> id[i];
        Impact expected{true};
        file >> expected.toi >> expected.start;
        ASSERT_TRUE(file) << "line " << line;
        if (line % step.every != 0) continue;
        ++asked;
        const Move move =
            face ? Move{Feature::vertex_face,
                        {frames.vertex(id[0]), frames.corner(id[1], 0), frames.corner(id[1], 1),
                         frames.corner(id[1], 2)}}
                 : Move{Feature::edge_edge,
                        {frames.vertex(id[0]), frames.vertex(id[1]), frames.vertex(id[2]), frames.vertex(id[3])}};
        EXPECT_EQ(move.impact(), expected) << "line " << line << ": " << move;
    }
    EXPECT_EQ(asked, step.asked);
}

INSTANTIATE_TEST_SUITE_P(GroundTruth, ImpactTruth,
                         testing::Values(Step{"motion_cloth-funnel_227_228.txt", "cloth-funnel/frames/227.ply",
                                              "cloth-funnel/frames/228.ply", 1, 134},
                                         Step{"motion_cloth-ball_92_93.txt", "cloth-ball/frames/cloth_ball92.ply",
                                              "cloth-ball/frames/cloth_ball93.ply", 50, 2278},
                                         Step{"motion_n-body_18_19.txt", "n-body-simulation/frames/balls16_18.ply",
                                              "n-body-simulation/frames/balls16_19.ply", 50, 1010}),
                         [](const auto& info) {
                             std::string name = info.param.answer.substr(0, info.param.answer.find('.'));
                             for (char& c : name) c = c == '-' ? '_' : c;
                             return name;
                         });

}  // namespace
}  // namespace crumple
