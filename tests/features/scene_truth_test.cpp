// Compares impacts and proximities of real scenes with independent exact results: whole lists as sets, values bit by
// bit.

#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "crumple/crumple.h"
#include "crumple/io.h"
#include "io/files.h"

namespace crumple {
namespace {

namespace fs = std::filesystem;

/// A row of a list; edges are given by their vertices.
struct Line {
    bool edges;
    std::array<std::int32_t, 4> id;
    double value;
    bool flag;
    friend bool operator==(const Line&, const Line&) = default;
    friend std::ostream& operator<<(std::ostream& out, const Line& line) {
        out << (line.edges ? "ee" : "vf");
        for (const std::int32_t id : line.id) out << ' ' << id;
        return out << ' ' << line.value << ' ' << line.flag;
    }
};

std::vector<Line> read_list(const fs::path& path, bool motion) {
    std::ifstream file(path);
    std::vector<Line> lines;
    for (std::string kind; file >> kind;) {
        Line line{kind == "ee", {}, 0, false};
        for (std::size_t i = 0; i < (line.edges ? 4U : 2U); ++i) file >> line.id[i];
        file >> line.value;
        if (motion)
            file >> line.flag;
        else
            line.flag = line.value == 0;
        EXPECT_TRUE(file) << "line " << lines.size();
        lines.push_back(line);
    }
    return lines;
}

template <class Result, class Values, class Flags>
std::vector<Line> lines_of(const Result& result, Values values, Flags flags) {
    std::vector<Line> lines;
    for (const bool edges : {false, true}) {
        const auto& list = edges ? result.edge_edges() : result.vertex_faces();
        for (std::size_t i = 0; i < list.pairs.size(); ++i) {
            const Pair pair = list.pairs[i];
            Line line{edges, {pair.a, pair.b}, values(list)[i], flags(list)[i] != 0};
            if (edges) {
                const Edge e = result.edges[pair.a], f = result.edges[pair.b];
                line.id = {e.a, e.b, f.a, f.b};
            }
            lines.push_back(line);
        }
    }
    return lines;
}

void expect_equal(const std::vector<Line>& found, const std::vector<Line>& expected) {
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) ASSERT_EQ(found[i], expected[i]) << "line " << i;
}

std::optional<fs::path> truth(const std::string& truth_file) {
    const auto folder = io::test::data_folder();
    if (!folder || !fs::exists(*folder / "gt-motion" / truth_file)) return {};
    return folder;
}

io::TriangleMesh frame(const fs::path& folder, const std::string& name) {
    return io::read_mesh(folder / "scalable-ccd" / name);
}

struct Case {
    std::string name, truth_file, start, end;
    double radius;
    friend std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }
};

class FeatureTruth : public testing::TestWithParam<Case> {};
std::string name_of(const testing::TestParamInfo<Case>& info) { return info.param.name; }

class ImpactsOfScenes : public FeatureTruth {};

TEST_P(ImpactsOfScenes, impacts_match_ground_truth) {
    const auto folder = truth(GetParam().truth_file);
    if (!folder) GTEST_SKIP() << "no exact answers for moving scenes";
    const io::TriangleMesh start = frame(*folder, GetParam().start), end = frame(*folder, GetParam().end);
    Detector detector;
    const Impacts& impacts = detector.find(start.view().moving_to(end.view().vertices), ImpactQuery());
    const std::vector<Line> expected = read_list(*folder / "gt-motion" / GetParam().truth_file, true);
    expect_equal(lines_of(
                     impacts, [](const auto& list) -> auto& { return list.toi; },
                     [](const auto& list) -> auto& { return list.start; }),
                 expected);

    const auto first = std::min_element(expected.begin(), expected.end(),
                                        [](const Line& a, const Line& b) { return a.value < b.value; });
    const FirstImpact found = detector.find(start.view().moving_to(end.view().vertices), FirstImpactQuery());
    EXPECT_EQ(found.toi, first->value);
    EXPECT_EQ(found.kind, first->edges ? FeatureKind::edge_edge : FeatureKind::vertex_face);
    EXPECT_TRUE(detector.any(start.view().moving_to(end.view().vertices), ImpactQuery()));
}

INSTANTIATE_TEST_SUITE_P(
    GroundTruth, ImpactsOfScenes,
    testing::Values(Case{"funnel", "motion_cloth-funnel_227_228.txt", "cloth-funnel/frames/227.ply",
                         "cloth-funnel/frames/228.ply", 0},
                    Case{"cloth_ball", "motion_cloth-ball_92_93.txt", "cloth-ball/frames/cloth_ball92.ply",
                         "cloth-ball/frames/cloth_ball93.ply", 0},
                    Case{"n_body", "motion_n-body_18_19.txt", "n-body-simulation/frames/balls16_18.ply",
                         "n-body-simulation/frames/balls16_19.ply", 0}),
    name_of);

class NearPairsOfScenes : public FeatureTruth {};

TEST_P(NearPairsOfScenes, proximities_match_ground_truth) {
    const auto folder = truth(GetParam().truth_file);
    if (!folder) GTEST_SKIP() << "no exact answers for near pairs";
    const io::TriangleMesh mesh = frame(*folder, GetParam().start);
    Detector detector;
    const Proximities& nearby = detector.find(mesh.view(), ProximityQuery{.radius = GetParam().radius});
    expect_equal(lines_of(
                     nearby, [](const auto& list) -> auto& { return list.squared_distance; },
                     [](const auto& list) -> auto& { return list.touching; }),
                 read_list(*folder / "gt-motion" / GetParam().truth_file, false));
}

INSTANTIATE_TEST_SUITE_P(GroundTruth, NearPairsOfScenes,
                         testing::Values(Case{"funnel", "prox_cloth-funnel_227.txt", "cloth-funnel/frames/227.ply", "",
                                              0.0047773383557796478},
                                         Case{"cloth_ball", "prox_cloth-ball_92.txt",
                                              "cloth-ball/frames/cloth_ball92.ply", "", 0.054098617285490036},
                                         Case{"n_body", "prox_n-body_18.txt", "n-body-simulation/frames/balls16_18.ply",
                                              "", 0.020874753594398499}),
                         name_of);

}  // namespace
}  // namespace crumple
