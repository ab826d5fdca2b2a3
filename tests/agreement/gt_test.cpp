// Compares the tested backend, and on small scenes brute force, with independent exact results on real scenes: pairs as
// sets, in both precisions, for all kinds of intersections and with adjacent triangles skipped or not.

#include <fstream>
#include <memory>
#include <string>

#include "agreement/compare.h"
#include "io/files.h"
#include "rounds.h"

namespace crumple {
namespace {

using io::Precision;
using test::backend_name;
using test::same_pairs;
namespace fs = std::filesystem;

/// One line of a ground-truth file: an intersecting pair of triangles, the number of distinct vertices that both use
/// (`shared`), the number of extreme points of their intersection (`points`), and 1 if an edge of one triangle strictly
/// crosses the interior of the other (`strict`). The tests do not use `degenerate`.
struct Line {
    Pair pair;
    int shared, degenerate, points, strict;
};

struct Truth {
    std::vector<Line> lines;

    template <class Predicate>
    std::vector<Pair> pairs(Predicate is_chosen) const {
        std::vector<Pair> chosen;
        for (const Line& line : lines) {
            if (is_chosen(line)) chosen.push_back(line.pair);
        }
        return chosen;
    }
};

class DataTest : public testing::Test {
   protected:
    void SetUp() override {
        if (!folder) GTEST_SKIP() << "no scenes: set CRUMPLE_DATA";
    }
    std::ifstream open(const std::string& truth_file) const {
        std::ifstream file(*folder / "gt" / truth_file);
        EXPECT_TRUE(file) << truth_file;
        return file;
    }
    Truth truth(const std::string& truth_file) const {
        Truth truth;
        std::ifstream file = open(truth_file);
        Line x;
        while (file >> x.pair.a >> x.pair.b >> x.shared >> x.degenerate >> x.points >> x.strict)
            truth.lines.push_back(x);
        return truth;
    }
    std::optional<fs::path> folder = io::test::data_folder();
};

// Besides brute force, these tests verify one backend, test::tested_backend (tested_backend.h).

/// Returns the backends to compare with the ground truth. Leaves out brute force for more than 1,500 triangles, where
/// it would take more than a second.
std::vector<Backend> backends_for(std::int64_t triangles) {
    if (triangles <= 1'500) return {Backend::reference, test::tested_backend};
    return {test::tested_backend};
}

Detector detector_of(Backend backend) {
    Options options;
    options.backend = backend;
    return Detector(options);
}

void expect_truth(Detector& detector, const MeshView& mesh, const Truth& truth) {
    IntersectionQuery query;
    const auto found = [&] { return detector.find(mesh, query).pairs.span(); };
    EXPECT_TRUE(same_pairs(found(), truth.pairs([](const Line&) { return true; })));
    EXPECT_EQ(detector.any(mesh, query), !truth.lines.empty());
    query.kind = IntersectionKind::proper;
    EXPECT_TRUE(same_pairs(found(), truth.pairs([](const Line& line) { return line.strict == 1; }))) << "proper";
    query.neighbours = Neighbours::skip;
    EXPECT_TRUE(same_pairs(found(), truth.pairs([](const Line& line) { return line.strict == 1 && line.shared == 0; })))
        << "proper, neighbours skipped";
    query.kind = IntersectionKind::all;
    EXPECT_TRUE(same_pairs(found(), truth.pairs([](const Line& line) { return line.shared == 0; })))
        << "neighbours skipped";
}

void expect_contacts(Detector& detector, const MeshView& mesh, const Truth& truth) {
    IntersectionQuery query;
    query.output = Output::contacts;
    const Contacts& contacts = detector.find(mesh, query).contacts;
    ASSERT_EQ(contacts.kinds.size(), truth.lines.size());
    ASSERT_EQ(contacts.offsets.size(), truth.lines.size() + 1);
    for (std::size_t i = 0; i < truth.lines.size(); ++i) {
        const int points = truth.lines[i].points;
        ASSERT_EQ(contacts.offsets[i + 1] - contacts.offsets[i], points) << testing::PrintToString(truth.lines[i].pair);
        ASSERT_EQ(static_cast<int>(contacts.kinds[i]), std::min(points, 3))
            << testing::PrintToString(truth.lines[i].pair);
    }
}

struct SelfCase {
    const char* mesh;
    const char* truth_file;
    Precision precision = Precision::automatic;
    friend std::ostream& operator<<(std::ostream& out, const SelfCase& c) { return out << c.truth_file; }
};

/// Names tests by their ground-truth files.
const auto name_of = [](const auto& info) { return test::test_name(info.param.truth_file); };

/// Returns the only precision in which the ground truth holds, or both precisions if it does not depend on the
/// precision.
std::vector<Precision> precisions(const SelfCase& scene) {
    if (scene.precision != Precision::automatic) return {scene.precision};
    return {Precision::float32, Precision::float64};
}

std::vector<int> part_counts(const SelfCase& scene);

class SelfTruth : public DataTest, public testing::WithParamInterface<SelfCase> {};

TEST_P(SelfTruth, pairs_and_contact_point_counts_match_ground_truth) {
    const SelfCase scene = GetParam();
    const Truth expected = truth(scene.truth_file);
    for (const Precision precision : precisions(scene)) {
        const io::TriangleMesh mesh =
            io::read_mesh(*folder / scene.mesh, {.precision = precision, .triangulation = io::Triangulation::fan});
        for (const Backend backend : backends_for(mesh.triangle_count())) {
            SCOPED_TRACE(testing::Message()
                         << backend_name(backend) << ", " << (precision == Precision::float32 ? "float32" : "float64"));
            Detector detector = detector_of(backend);
            expect_truth(detector, mesh.view(), expected);
            expect_contacts(detector, mesh.view(), expected);
        }
    }
}

// Largest number of overlapping boxes for brute force: its rational arithmetic takes 20 us for each pair, several times
// that under sanitizers. Larger scenes are compared with the ground truth only.
const std::int64_t most_overlaps = thorough() ? 200'000 : sanitized ? 20'000 : 50'000;
TEST_P(SelfTruth, tested_backend_finds_the_pairs_of_brute_force) {
    const SelfCase scene = GetParam();
    const io::TriangleMesh mesh =
        io::read_mesh(*folder / scene.mesh, {.precision = scene.precision, .triangulation = io::Triangulation::fan});
    if (mesh.triangle_count() > 20'000) GTEST_SKIP() << "too large";
    if (backends_for(mesh.triangle_count()).size() > 1)
        GTEST_SKIP() << "small, so compared in pairs_and_contact_point_counts_match_ground_truth";
    Detector detector = detector_of(test::tested_backend), reference = detector_of(Backend::reference);
    const Intersections& found = detector.find(mesh.view());
    if (found.statistics.box_overlaps > most_overlaps) GTEST_SKIP() << "too many boxes overlap";
    EXPECT_TRUE(same_pairs(reference.find(mesh.view()).pairs.span(), found.pairs.span()));
}

// Uses two numbers of parts for each scene; the numbers of all scenes together cover 1 to 64.
TEST_P(SelfTruth, pairs_of_parts_add_up_to_all_pairs) {
    const SelfCase scene = GetParam();
    const io::TriangleMesh mesh =
        io::read_mesh(*folder / scene.mesh, {.precision = scene.precision, .triangulation = io::Triangulation::fan});
    Detector detector = detector_of(test::tested_backend);
    const std::vector<Pair> whole = test::pairs_of(detector.find(mesh.view()));
    for (const int count : part_counts(scene)) {
        std::vector<Pair> joined;
        for (const Part& part : detector.partition(mesh.view(), {}, count)) {
            const Intersections& found = detector.find(part);
            joined.insert(joined.end(), found.pairs.begin(), found.pairs.end());
        }
        std::sort(joined.begin(), joined.end());
        EXPECT_TRUE(joined == whole) << count << " parts, " << joined.size() << " pairs instead of " << whole.size();
    }
}

constexpr Precision single = Precision::float32, twofold = Precision::float64;
const SelfCase self_cases[] = {
    {"soups/soup_degenerate.ply", "soup_degenerate.txt"},
    {"soups/soup_grid.ply", "soup_grid.txt"},
    {"soups/soup_huge32.ply", "soup_huge32.txt"},
    {"soups/soup_repeat.ply", "soup_repeat.txt"},
    {"soups/soup_tiny64.ply", "soup_tiny64.f64.txt", twofold},
    {"ipc-toolkit-test-data/bunny.ply", "ipc_bunny.txt"},
    {"ipc-toolkit-test-data/height-field.ply", "ipc_height-field.txt"},
    {"ipc-toolkit-test-data/highres-cube.ply", "ipc_highres-cube.txt"},
    {"ipc-toolkit-test-data/spike-plane.ply", "ipc_spike-plane.txt"},
    {"ipc-toolkit-test-data/two-layer-ball.ply", "ipc_two-layer-ball.txt"},
    {"ipc-toolkit-test-data/uv-ball.ply", "ipc_uv-ball.txt"},
    {"ipc-toolkit-test-data/two-cubes-close.ply", "two-cubes-close.txt"},
    {"ipc-toolkit-test-data/two-cubes-far.ply", "two-cubes-far.txt"},
    {"ipc-toolkit-test-data/two-cubes-intersecting.ply", "two-cubes-intersecting.txt"},
    {"ipc-toolkit-test-data/thick-cloth/t0.ply", "thick-cloth-t0.txt"},
    {"ipc-toolkit-test-data/thick-cloth/t1.ply", "thick-cloth-t1.txt"},
    {"meshes/Generic_Twin_right.obj", "Generic_Twin_right.f32.txt", single},
    {"meshes/Generic_Twin_right.obj", "Generic_Twin_right.f64.txt", twofold},
    {"meshes/armadillo_86k.obj", "armadillo_86k.txt"},
    {"meshes/bunny_69k.obj", "bunny_69k.txt"},
    {"meshes/dragon_100k.ply", "dragon_100k.txt"},
    {"meshes/hull-mask.obj", "hull-mask.txt"},
    {"meshes/human_neutral.obj", "human_neutral.txt"},
    {"meshes/lucy_100k.ply", "lucy_100k.txt"},
    {"meshes/ogre_124k.obj", "ogre_124k.f32.txt", single},
    {"meshes/ogre_124k.obj", "ogre_124k.f64.txt", twofold},
    {"meshes/self_intersectA_17k.obj", "self_intersectA_17k.txt"},
    {"meshes/shark_50k.stl", "shark_50k.txt"},
    {"meshes/truck.obj", "truck.f32.txt", single},
    {"meshes/truck.obj", "truck.f64.txt", twofold},
    {"meshes/turbineblade_199k.ply", "turbineblade_199k.txt"},
    {"scalable-ccd/cloth-ball/frames/cloth_ball92.ply", "cloth_ball92.txt"},
    {"scalable-ccd/cloth-ball/frames/cloth_ball93.ply", "cloth_ball93.txt"},
    {"scalable-ccd/cloth-funnel/frames/227.ply", "cloth_funnel227.txt"},
    {"scalable-ccd/cloth-funnel/frames/228.ply", "cloth_funnel228.txt"},
    {"scalable-ccd/n-body-simulation/frames/balls16_18.ply", "balls16_18.txt"},
    {"scalable-ccd/n-body-simulation/frames/balls16_19.ply", "balls16_19.txt"},
};

std::vector<int> part_counts(const SelfCase& scene) {
    const auto same = [&](const SelfCase& c) { return std::string_view(c.truth_file) == scene.truth_file; };
    const auto number = static_cast<int>(std::find_if(std::begin(self_cases), std::end(self_cases), same) - self_cases);
    return {1 + number, 64 - number};
}

INSTANTIATE_TEST_SUITE_P(GroundTruth, SelfTruth, testing::ValuesIn(self_cases), name_of);

class WeldedTruth : public DataTest, public testing::WithParamInterface<SelfCase> {};

TEST_P(WeldedTruth, welded_pairs_match_ground_truth) {
    const SelfCase scene = GetParam();
    std::vector<Pair> expected;
    std::ifstream file = open(scene.truth_file);
    for (Pair pair; file >> pair.a >> pair.b;) expected.push_back(pair);
    ASSERT_FALSE(expected.empty());

    Detector detector = detector_of(test::tested_backend);
    IntersectionQuery query;
    query.weld = true;
    for (const Precision precision : precisions(scene)) {
        const io::TriangleMesh mesh =
            io::read_mesh(*folder / scene.mesh, {.precision = precision, .triangulation = io::Triangulation::fan});
        EXPECT_TRUE(same_pairs(detector.find(mesh.view(), query).pairs.span(), expected));
    }
}

INSTANTIATE_TEST_SUITE_P(GroundTruth, WeldedTruth,
                         testing::Values(SelfCase{"scalable-ccd/n-body-simulation/frames/balls16_18.ply",
                                                  "balls16_18_welded.pairs.txt"},
                                         SelfCase{"meshes/ogre_124k.obj", "ogre_124k_welded.f32.pairs.txt", single},
                                         SelfCase{"meshes/ogre_124k.obj", "ogre_124k_welded.f64.pairs.txt", twofold}),
                         name_of);

struct BetweenCase {
    const char *a, *b, *truth_file;
    friend std::ostream& operator<<(std::ostream& out, const BetweenCase& c) { return out << c.truth_file; }
};

class BetweenTruth : public DataTest, public testing::WithParamInterface<BetweenCase> {};

TEST_P(BetweenTruth, pairs_of_two_meshes_match_ground_truth) {
    const BetweenCase scene = GetParam();
    std::vector<Pair> all, coincident_none, proper;
    std::ifstream file = open(scene.truth_file);
    int coincident = 0, strict = 0;
    for (Pair pair; file >> pair.a >> pair.b >> coincident >> strict;) {
        all.push_back(pair);
        if (coincident == 0) coincident_none.push_back(pair);
        if (strict == 1) proper.push_back(pair);
    }
    ASSERT_FALSE(all.empty());

    Detector detector = detector_of(test::tested_backend);
    for (const Precision precision : {single, twofold}) {
        const io::TriangleMesh a =
            io::read_mesh(*folder / scene.a, {.precision = precision, .triangulation = io::Triangulation::fan});
        const io::TriangleMesh b =
            io::read_mesh(*folder / scene.b, {.precision = precision, .triangulation = io::Triangulation::fan});
        IntersectionQuery query;
        EXPECT_TRUE(same_pairs(detector.find({a.view(), b.view()}, query).pairs.span(), all));
        EXPECT_TRUE(detector.any({a.view(), b.view()}, query));
        query.kind = IntersectionKind::proper;
        EXPECT_TRUE(same_pairs(detector.find({a.view(), b.view()}, query).pairs.span(), proper));
        query = {};
        query.weld = true;
        query.neighbours = Neighbours::skip;
        EXPECT_TRUE(same_pairs(detector.find({a.view(), b.view()}, query).pairs.span(), coincident_none));
    }
}

INSTANTIATE_TEST_SUITE_P(GroundTruth, BetweenTruth,
                         testing::Values(BetweenCase{"thingi10k-ember/case016_a_88566.ply",
                                                     "thingi10k-ember/case016_b_58011.ply", "ember_case016.a_vs_b.txt"},
                                         BetweenCase{"thingi10k-ember/case260_a_908460.ply",
                                                     "thingi10k-ember/case260_b_73416.ply", "ember_case260.a_vs_b.txt"},
                                         BetweenCase{"thingi10k-ember/case406_a_1063852.ply",
                                                     "thingi10k-ember/case406_b_72214.ply",
                                                     "ember_case406.a_vs_b.txt"}),
                         name_of);

class Frames : public DataTest {};

// Compares cloth and ball both as groups of one soup and as two meshes.
TEST_F(Frames, cloth_and_ball_do_not_meet_in_two_frames) {
    for (const char* frame : {"cloth_ball92.ply", "cloth_ball93.ply"}) {
        io::TriangleMesh mesh = io::read_mesh(*folder / "scalable-ccd/cloth-ball/frames" / frame);
        constexpr std::int64_t cloth_end = 91'470;
        mesh.groups.assign(static_cast<std::size_t>(mesh.triangle_count()), 0);
        std::fill(mesh.groups.begin() + cloth_end, mesh.groups.end(), 1);
        Detector detector = detector_of(test::tested_backend);
        IntersectionQuery query;
        query.filter.groups = PairScope::between;
        EXPECT_TRUE(same_pairs(detector.find(mesh.view(), query).pairs.span(), {}));

        MeshView cloth = mesh.view(), ball = mesh.view();
        cloth.groups = ball.groups = {};
        cloth.triangles.rows = cloth_end;
        ball.triangles.data = static_cast<const char*>(ball.triangles.data) + cloth_end * ball.triangles.row_stride;
        ball.triangles.rows -= cloth_end;
        EXPECT_TRUE(same_pairs(detector.find({cloth, ball}).pairs.span(), {}));
        EXPECT_FALSE(detector.any({cloth, ball}));
    }
}

// Uses one detector for all frames, so that each is warm-started from the cluster centres of the frame before.
TEST_F(Frames, pair_counts_of_warm_started_frames_match_ground_truth) {
    constexpr std::int64_t vertices = 12'811, triangles = 25'472;
    std::vector<std::int32_t> corners(3 * triangles);
    std::vector<float> xyz(3 * vertices);
    std::ifstream faces(*folder / "codim-ipc/Kick/faces.i32", std::ios::binary);
    std::ifstream positions(*folder / "codim-ipc/Kick/verts.f32", std::ios::binary);
    faces.read(reinterpret_cast<char*>(corners.data()),
               static_cast<std::streamsize>(corners.size() * sizeof(corners[0])));
    ASSERT_TRUE(faces);
    std::ifstream counts = open("Kick.counts.csv");
    std::string heading;
    std::getline(counts, heading);

    Detector detector = detector_of(test::tested_backend);
    int frame, all, skip, neighbours;
    char comma;
    int frames = 0;
    while (counts >> frame >> comma >> all >> comma >> skip >> comma >> neighbours) {
        SCOPED_TRACE(testing::Message() << "frame " << frame);
        positions.read(reinterpret_cast<char*>(xyz.data()), static_cast<std::streamsize>(xyz.size() * sizeof(xyz[0])));
        ASSERT_TRUE(positions);
        const MeshView mesh(xyz.data(), vertices, corners.data(), triangles);
        ASSERT_EQ(detector.find(mesh).pairs.size(), static_cast<std::size_t>(all));
        if (frame % 30 == 0) {
            const std::string number = std::to_string(1000 + frame).substr(1);
            const Truth expected = truth("Kick_" + number + ".txt");
            ASSERT_EQ(expected.lines.size(), static_cast<std::size_t>(all));
            expect_truth(detector, mesh, expected);
            expect_contacts(detector, mesh, expected);
        }
        ++frames;
    }
    EXPECT_EQ(frames, 121);
}

}  // namespace
}  // namespace crumple
