// Compares distances of features in frames of real scenes bit by bit with exact results of external origin.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "crumple/io.h"
#include "exact/proximity/decide_distance.h"
#include "io/files.h"
#include "proximities/feature_builders.h"

namespace crumple {
namespace {

namespace fs = std::filesystem;

struct Frame {
    std::string result_file, mesh;  ///< names of the file of exact results and of the mesh
    double radius;
    std::size_t every;  ///< interval of the lines that are also checked in rational arithmetic
    std::size_t lines, touching;
    friend std::ostream& operator<<(std::ostream& out, const Frame& frame) { return out << frame.result_file; }
};

class Mesh {
   public:
    explicit Mesh(const fs::path& file) : mesh_(io::read_mesh(file, {.precision = io::Precision::float64})) {}

    Vec3d vertex(std::int32_t i) const {
        const auto& xyz = std::get<std::vector<double>>(mesh_.vertices);
        const auto at = 3 * static_cast<std::size_t>(i);
        return {xyz.at(at), xyz.at(at + 1), xyz.at(at + 2)};
    }
    using Ids = std::array<std::int32_t, 3>;
    Ids face(std::int32_t i) const {
        const auto at = 3 * static_cast<std::size_t>(i);
        return {mesh_.triangles.at(at), mesh_.triangles.at(at + 1), mesh_.triangles.at(at + 2)};
    }
    std::int32_t faces() const { return static_cast<std::int32_t>(mesh_.triangles.size() / 3); }

    Features vertex_and_face(std::int32_t v, std::int32_t f) const {
        const auto [a, b, c] = face(f);
        return vertex_face(vertex(v), vertex(a), vertex(b), vertex(c));
    }
    Features edges(std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) const {
        return edge_edge(vertex(a), vertex(b), vertex(c), vertex(d));
    }

   private:
    io::TriangleMesh mesh_;
};

/// Line of a file of results.
struct Line {
    bool face;
    std::array<std::int32_t, 4> id{};  ///< a vertex and a face, or two edges by their ends
    double squared;

    Features features(const Mesh& mesh) const {
        return face ? mesh.vertex_and_face(id[0], id[1]) : mesh.edges(id[0], id[1], id[2], id[3]);
    }
};

std::vector<Line> read_lines(const fs::path& path) {
    std::ifstream file(path);
    std::vector<Line> lines;
    std::string kinds;
    while (file >> kinds) {
        Line line{kinds == "vf", {}, 0};
        for (std::size_t i = 0; i < (line.face ? 2U : 4U); ++i) file >> line.id[i];
        if (!(file >> line.squared)) throw std::runtime_error("a line that cannot be read");
        lines.push_back(line);
    }
    return lines;
}

class DistanceTruth : public testing::TestWithParam<Frame> {
   protected:
    void SetUp() override {
        const auto folder = io::test::data_folder();
        if (!folder) GTEST_SKIP() << "no scenes: set CRUMPLE_DATA";
        const fs::path result_file = *folder / "gt-motion" / GetParam().result_file;
        if (!fs::exists(result_file)) GTEST_SKIP() << "no answers for features that are near";
        mesh_.emplace(*folder / "scalable-ccd" / GetParam().mesh);
        lines_ = read_lines(result_file);
    }

    std::optional<Mesh> mesh_;
    std::vector<Line> lines_;
};

TEST_P(DistanceTruth, distances_match_ground_truth_to_the_last_bit) {
    const Frame& frame = GetParam();
    const double radius = frame.radius;
    DistanceCounts counts;
    std::size_t touching = 0;
    for (std::size_t i = 0; i < lines_.size(); ++i) {
        const Line& line = lines_[i];
        const Features features = line.features(*mesh_);
        touching += line.squared == 0;
        Distance distance(features, counts);
        ASSERT_TRUE(distance.within({0.25 * radius, 0.75 * radius, false})) << features;
        ASSERT_EQ(distance.squared(), line.squared) << "line " << i << ": " << features;
        if (i % frame.every != 0) continue;
        const RationalDistance exact(features);
        ASSERT_EQ(exact.squared(), line.squared) << "line " << i << ": " << features;
        ASSERT_EQ(exact.touching(), line.squared == 0) << features;
        ASSERT_TRUE(exact.within({radius, 0, true})) << features;
        ASSERT_EQ(distance.touching(), exact.touching()) << features;
        ASSERT_EQ(distance.closest(), exact.closest()) << features;
        const double down = exact.rounded_down();
        ASSERT_EQ(distance.rounded_down(), down) << features;
        for (const double beside : {std::nextafter(down, 0), down, std::nextafter(down, 1)}) {
            for (const bool strict : {false, true}) {
                const DistanceLimit reach{beside, 0, strict};
                ASSERT_EQ(distance.within(reach), exact.within(reach)) << features << " at " << beside;
            }
        }
    }
    EXPECT_EQ(lines_.size(), frame.lines);
    EXPECT_EQ(touching, frame.touching);
    EXPECT_LE(counts.rational, static_cast<std::int64_t>(lines_.size() / 100 + touching)) << "of " << lines_.size();
}

/// Interval of an item along an axis.
struct Interval {
    double low, high;
    std::int32_t item;
};

/// Calls visit(x, y) once for each two items of `a` and `b` whose intervals come closer than `gap`.
template <class Visit>
void for_close_intervals(std::vector<Interval> a, std::vector<Interval> b, double gap, Visit visit) {
    const auto by_low = [](const Interval& x, const Interval& y) { return x.low < y.low; };
    std::sort(a.begin(), a.end(), by_low);
    std::sort(b.begin(), b.end(), by_low);
    const auto each = [&](const auto& from, const auto& to, bool ties, auto found) {
        std::size_t first = 0;
        for (const Interval& x : from) {
            while (first < to.size() && (to[first].low < x.low || (ties && to[first].low == x.low))) ++first;
            for (std::size_t i = first; i < to.size() && to[i].low <= x.high + gap; ++i) found(x.item, to[i].item);
        }
    };
    each(a, b, false, [&](std::int32_t x, std::int32_t y) { visit(x, y); });
    each(b, a, true, [&](std::int32_t x, std::int32_t y) { visit(y, x); });
}

class NearPairs : public DistanceTruth {};

// Counts the near pairs of all features. DistanceTruth checks that all pairs in the list are near, so equal numbers
// mean equal sets.
TEST_P(NearPairs, number_of_near_pairs_matches_ground_truth) {
    const Mesh& mesh = *mesh_;
    const DistanceLimit reach{GetParam().radius, 0, false};
    const auto interval = [&](std::int32_t item, std::initializer_list<std::int32_t> ids) {
        Interval result{1e300, -1e300, item};
        for (const std::int32_t id : ids) {
            result.low = std::min(result.low, mesh.vertex(id).z);
            result.high = std::max(result.high, mesh.vertex(id).z);
        }
        return result;
    };
    std::set<std::int32_t> named;
    std::set<std::array<std::int32_t, 2>> unique_edges;
    std::vector<Interval> vertices, faces, edges;
    for (std::int32_t f = 0; f < mesh.faces(); ++f) {
        const auto [a, b, c] = mesh.face(f);
        named.insert({a, b, c});
        unique_edges.insert({std::array{std::min(a, b), std::max(a, b)}, std::array{std::min(b, c), std::max(b, c)},
                             std::array{std::min(c, a), std::max(c, a)}});
        faces.push_back(interval(f, {a, b, c}));
    }
    const std::vector<std::array<std::int32_t, 2>> edge(unique_edges.begin(), unique_edges.end());
    for (const std::int32_t v : named) vertices.push_back(interval(v, {v}));
    for (std::size_t e = 0; e < edge.size(); ++e)
        edges.push_back(interval(static_cast<std::int32_t>(e), {edge[e][0], edge[e][1]}));

    DistanceCounts counts;
    std::size_t within = 0;
    for_close_intervals(vertices, faces, reach.a, [&](std::int32_t v, std::int32_t f) {
        const auto corners = mesh.face(f);
        if (std::find(corners.begin(), corners.end(), v) != corners.end()) return;
        const Features features = mesh.vertex_and_face(v, f);
        within += !surely_out_of_reach(features, reach) && Distance(features, counts).within(reach);
    });
    for_close_intervals(edges, edges, reach.a, [&](std::int32_t e, std::int32_t f) {
        const auto [a, b] = edge[static_cast<std::size_t>(e)];
        const auto [c, d] = edge[static_cast<std::size_t>(f)];
        if (e >= f || a == c || a == d || b == c || b == d) return;
        const Features features = mesh.edges(a, b, c, d);
        within += !surely_out_of_reach(features, reach) && Distance(features, counts).within(reach);
    });
    EXPECT_EQ(within, lines_.size());
}

const Frame funnel{"prox_cloth-funnel_227.txt", "cloth-funnel/frames/227.ply", 0.0047773383557796478, 1, 23'483, 0};
const Frame ball{"prox_cloth-ball_92.txt", "cloth-ball/frames/cloth_ball92.ply", 0.054098617285490036, 10, 727'210, 0};
const Frame balls{
    "prox_n-body_18.txt", "n-body-simulation/frames/balls16_18.ply", 0.020874753594398499, 1, 98'012, 3'520};

std::string test_name(const testing::TestParamInfo<Frame>& info) {
    std::string name = info.param.result_file.substr(0, info.param.result_file.find('.'));
    for (char& c : name) c = c == '-' ? '_' : c;
    return name;
}

INSTANTIATE_TEST_SUITE_P(GroundTruth, DistanceTruth, testing::Values(funnel, ball, balls), test_name);
INSTANTIATE_TEST_SUITE_P(GroundTruth, NearPairs, testing::Values(funnel), test_name);

}  // namespace
}  // namespace crumple
