// Separations between frames of real scenes, against exact answers from outside: impacts, which are separations of
// nothing, and squared distances at the start.

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>
#include <variant>

#include "crumple/io.h"
#include "io/files.h"
#include "questions/motion/separated_moves.h"

namespace crumple {
namespace {

namespace fs = std::filesystem;

struct Scene {
    std::string impacts, distances, start, end;  ///< names of files
    int every;                                   ///< how many lines of an answer stand for one that is asked
    friend std::ostream& operator<<(std::ostream& out, const Scene& scene) { return out << scene.impacts; }
};

const Scene scenes[] = {
    {"motion_cloth-funnel_227_228", "prox_cloth-funnel_227", "cloth-funnel/frames/227.ply",
     "cloth-funnel/frames/228.ply", 1},
    {"motion_cloth-ball_92_93", "prox_cloth-ball_92", "cloth-ball/frames/cloth_ball92.ply",
     "cloth-ball/frames/cloth_ball93.ply", 200},
    {"motion_n-body_18_19", "prox_n-body_18", "n-body-simulation/frames/balls16_18.ply",
     "n-body-simulation/frames/balls16_19.ply", 100},
};

class SeparationTruth : public testing::TestWithParam<Scene> {
   protected:
    void SetUp() override {
        const auto folder = io::test::data_folder();
        if (!folder) GTEST_SKIP() << "no scenes: set CRUMPLE_DATA";
        answers_ = *folder / "gt-motion";
        if (!fs::exists(answers_)) GTEST_SKIP() << "no answers for moving scenes";
        const auto frame = [&](const std::string& name) {
            return io::read_mesh(*folder / "scalable-ccd" / name, {.precision = io::Precision::float64});
        };
        start_ = frame(GetParam().start);
        end_ = frame(GetParam().end);
    }

    /// Calls `check` with the moves of some lines of a file, and with the stream at what the line says of each.
    void for_lines(const std::string& file, int every, auto check) const {
        std::ifstream lines(answers_ / (file + ".txt"));
        std::string kind, rest;
        int line = 0;
        for (; lines >> kind; ++line) {
            const bool face = kind == "vf";
            std::array<std::int32_t, 4> id{};
            for (std::size_t i = 0; i < (face ? 2U : 4U); ++i) lines >> id[i];
            if (line % every == 0) {
                SeparatedMove asked{{face ? Feature::vertex_face : Feature::edge_edge, {}}, {}};
                const auto corner = [&](std::size_t i) {
                    return start_.triangles[3 * static_cast<std::size_t>(id[1]) + i];
                };
                if (face) id = {id[0], corner(0), corner(1), corner(2)};
                for (std::size_t i = 0; i < 4; ++i)
                    asked.move.point[i] = {position(start_, id[i]), position(end_, id[i])};
                check(asked, lines);
                ASSERT_TRUE(lines) << "line " << line;
            }
            std::getline(lines, rest);
        }
        EXPECT_GT(line, 100);
    }

   private:
    static Vec3d position(const io::TriangleMesh& mesh, std::int32_t vertex) {
        const auto at = 3 * static_cast<std::size_t>(vertex);
        const auto& xyz = std::get<std::vector<double>>(mesh.vertices);
        return {xyz.at(at), xyz.at(at + 1), xyz.at(at + 2)};
    }

    fs::path answers_;
    io::TriangleMesh start_, end_;
};

TEST_P(SeparationTruth, OfNothingIsAnImpact) {
    for_lines(GetParam().impacts, GetParam().every, [](const SeparatedMove& asked, auto& line) {
        Impact expected{true};
        line >> expected.toi >> expected.start;
        EXPECT_EQ(asked.impact(), expected) << asked;
    });
}

TEST_P(SeparationTruth, StartsAtTheExactDistance) {
    constexpr int more = 40;
    for_lines(GetParam().distances, more * GetParam().every, [](SeparatedMove asked, auto& line) {
        double squared = 0;
        line >> squared;
        const double distance = std::sqrt(squared);
        // The square is rounded, and so is its root; each by less than what this adds.
        asked.separation.distance = distance * (1 + 0x1p-51);
        EXPECT_TRUE(asked.impact().start) << asked;
        if (distance == 0) return;
        asked.separation.distance = distance * (1 - 0x1p-51);
        EXPECT_FALSE(asked.impact().start) << asked;
        // Half of the distance is a share of it, but for that rounding.
        asked.separation.distance = 0.5 * distance;
        const Impact half = asked.impact();
        asked.separation = {.distance = 0, .share = 0.5};
        const Impact share = asked.impact();
        EXPECT_NEAR(half.toi, share.toi, 1e-9) << asked;
        EXPECT_EQ(half.meets, share.meets) << asked;
    });
}

INSTANTIATE_TEST_SUITE_P(GroundTruth, SeparationTruth, testing::ValuesIn(scenes), [](const auto& info) {
    std::string name = info.param.impacts;
    for (char& c : name) c = c == '-' ? '_' : c;
    return name;
});

}  // namespace
}  // namespace crumple
