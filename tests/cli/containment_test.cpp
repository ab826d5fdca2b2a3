// Tests of crumple detect --groups bodies --containment: bodies inside others in lists, coloured meshes and many
// configurations.

#include <array>
#include <sstream>
#include <string>

#include <nlohmann/json.hpp>

#include "crumple/io.h"
#include "run.h"

namespace crumple::cli::test {
namespace {

/// Returns a cube in OFF with edges of length `size`, centre (x, 0, 0) and the first `triangles` of its 12 triangles.
std::string cube_off(double x, double size, int triangles = 12) {
    std::ostringstream out;
    out << "OFF\n8 " << triangles << " 0\n";
    for (int v = 0; v < 8; ++v)
        out << x + (v & 1 ? 0.5 : -0.5) * size << ' ' << (v & 2 ? 0.5 : -0.5) * size << ' '
            << (v & 4 ? 0.5 : -0.5) * size << '\n';
    constexpr std::array<const char*, 12> faces{"0 2 1", "1 2 3", "4 5 6", "5 7 6", "0 1 4", "1 5 4",
                                                "2 6 3", "3 6 7", "0 4 2", "2 4 6", "1 3 5", "3 7 5"};
    for (int t = 0; t < triangles; ++t) out << "3 " << faces[static_cast<std::size_t>(t)] << '\n';
    return out.str();
}

class Containment : public Cli {
   protected:
    Containment() {
        write("large.off", cube_off(0, 8));
        write("small.off", cube_off(1, 1));
        write("edge.off", cube_off(4, 1));
        write("open.off", cube_off(-1, 1, 11));
        write("open_large.off", cube_off(0, 8, 11));
    }
    /// Returns standard output of a run that must succeed.
    std::string list(const std::string& arguments) const {
        const Outcome outcome = crumple("detect --groups bodies " + arguments);
        EXPECT_EQ(outcome.status, 0) << arguments << outcome.err;
        return outcome.out;
    }
    void expect_refused(const std::string& arguments, const std::string& reason) const {
        const Outcome outcome = crumple("detect " + arguments);
        EXPECT_EQ(outcome.status, 2) << arguments;
        EXPECT_TRUE(is_error_line(outcome.err)) << arguments << ": " << outcome.err;
        EXPECT_TRUE(contains(outcome.err, reason)) << arguments << ": " << outcome.err;
    }
};

constexpr const char* three_files = "large.off small.off edge.off ";
constexpr const char* meeting = "large\tedge\n";
constexpr const char* with_inside = "large\tsmall\tinside\nlarge\tedge\n";

TEST_F(Containment, lists_mark_pairs_with_one_body_inside_the_other) {
    EXPECT_EQ(list(three_files), meeting);
    EXPECT_EQ(list(std::string(three_files) + "--containment"), with_inside);
    EXPECT_EQ(list(std::string(three_files) + "--containment --backend reference"), with_inside);
    const Outcome outcome =
        crumple("detect --groups bodies --containment " + std::string(three_files) + "-o p.txt -o p.csv -o p.json");
    EXPECT_TRUE(outcome.err.starts_with("2 pairs of bodies (1 inside), 3 of 3 bodies, ")) << outcome.err;
    EXPECT_EQ(read("p.txt"), with_inside);
    EXPECT_EQ(read("p.csv"), "first,second,inside\nlarge,small,1\nlarge,edge,0\n");
    const auto json = nlohmann::json::parse(read("p.json"));
    EXPECT_EQ(json["pairs"].dump(), R"([["large","small"],["large","edge"]])");
    EXPECT_EQ(json["inside"].dump(), "[true,false]");
}

TEST_F(Containment, lists_can_be_read_back_as_exclusions) {
    list(std::string(three_files) + "--containment -o p.txt -o p.csv -o p.json");
    for (const std::string name : {"p.txt", "p.csv", "p.json"})
        EXPECT_EQ(list(std::string(three_files) + "--containment --excluded-bodies-from " + name), "") << name;
    write("odd.txt", "large\tsmall\toutside\n");
    expect_refused(std::string(three_files) + "--groups bodies --excluded-bodies-from odd.txt",
                   "odd.txt, line 1: two names are expected");
}

TEST_F(Containment, check_reports_containment_by_exit_status) {
    EXPECT_EQ(crumple("detect --groups bodies --check large.off small.off").status, 0);
    EXPECT_EQ(crumple("detect --groups bodies --check --containment large.off small.off").status, 1);
    EXPECT_EQ(crumple("detect --groups bodies --check --containment small.off edge.off").status, 0);
}

TEST_F(Containment, row_of_a_configuration_counts_pairs_with_one_body_inside) {
    std::string poses;
    for (const double step : {0.0, 3.0, 20.0})
        poses += "1,0,0,0,0,1,0,0,0,0,1,0\n1,0,0," + std::to_string(step) + ",0,1,0,0,0,0,1,0\n";
    write("poses.csv", poses);
    const std::string of_two = "large.off small.off --poses poses.csv --containment ";
    EXPECT_EQ(list(of_two), "configuration,collides,pairs,inside\n0,1,1,1\n1,1,1,0\n2,0,0,0\n");
    EXPECT_EQ(list(of_two + "--any-by-world"), "configuration,collides\n0,1\n1,1\n2,0\n");
    list(of_two + "-o p.txt -o p.json");
    EXPECT_EQ(read("p.txt"), "0 yes 1 1\n1 yes 1 0\n2 no 0 0\n");
    const auto json = nlohmann::json::parse(read("p.json"));
    EXPECT_EQ(json["configurations"][0].dump(), R"({"collides":true,"inside":[true],"pairs":[["large","small"]]})");
    EXPECT_EQ(json["configurations"][1]["inside"].dump(), "[false]");
    EXPECT_EQ(crumple("detect --groups bodies --check " + of_two).status, 1);
}

TEST_F(Containment, open_bodies_whose_inside_matters_are_errors_unless_skipped) {
    expect_refused("--groups bodies --containment small.off open_large.off",
                   "open_large.off: body 'open_large': its surface is not closed");
    expect_refused("--groups bodies --containment large.off open.off",
                   "--weld closes seams, --open skip leaves such bodies out");
    const Outcome skipped = crumple(
        "detect --groups bodies --containment --open skip open.off large.off small.off open_large.off "
        "--excluded-bodies large,open_large");
    EXPECT_EQ(skipped.out, "open\tlarge\tinside\nlarge\tsmall\tinside\n") << skipped.err;
    EXPECT_TRUE(
        contains(skipped.err, "these bodies are not closed, and what lies inside does not collide: open, open_large"))
        << skipped.err;
    EXPECT_EQ(list("--containment open_large.off edge.off"), "open_large\tedge\n") << "surfaces meet";
}

TEST_F(Containment, containment_changes_colours_of_the_written_ply) {
    ASSERT_EQ(crumple("detect --groups bodies --containment large.off small.off -o c.ply -o c.glb -o p.txt").status, 0);
    EXPECT_EQ(read("p.txt"), "large\tsmall\tinside\n");
    EXPECT_EQ(io::read_mesh(file("c.ply")).triangle_count(), 24);
    ASSERT_EQ(crumple("detect --groups bodies large.off small.off -o grey.ply").status, 0);
    const auto red = [&](const char* name) { return io::read_mesh(file(name), {.group_property = "red"}).groups; };
    EXPECT_EQ(red("grey.ply"), std::vector<std::int32_t>(24, 178));
    EXPECT_NE(red("c.ply"), red("grey.ply"));
    EXPECT_EQ(io::read_mesh(file("c.ply")).vertices, io::read_mesh(file("grey.ply")).vertices);
    EXPECT_EQ(io::read_mesh(file("c.ply")).triangles, io::read_mesh(file("grey.ply")).triangles);
}

TEST_F(Containment, incompatible_options_are_refused) {
    expect_refused("large.off small.off --containment", "--containment needs --groups bodies");
    expect_refused("large.off --groups bodies --open skip", "--open needs --containment");
    expect_refused("large.off small.off --groups bodies --containment --kind proper", "kind must be all");
    expect_refused("large.off small.off --groups bodies --containment --filter within", "bodies must not be within");
}

}  // namespace
}  // namespace crumple::cli::test
