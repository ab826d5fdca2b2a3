#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "crumple/io.h"
#include "run.h"

namespace crumple::cli::test {
namespace {

class Detect : public Cli {
   protected:
    Detect() {
        write("five.off", five_off);
        write("two.off", two_off);
        write("near.off", near_off);
    }
    /// Returns standard output of a run. Expects success, and no message on standard error unless the list is empty.
    std::string pairs(const std::string& arguments) const {
        const Outcome outcome = crumple("detect " + arguments);
        EXPECT_EQ(outcome.status, 0) << arguments;
        EXPECT_TRUE(reports_empty_list(outcome)) << arguments << ": " << outcome.err;
        return outcome.out;
    }
    /// Returns standard error of a run. Expects success, exactly one line, and no pairs on standard output.
    std::string summary(const std::string& arguments) const {
        const Outcome outcome = crumple("detect " + arguments);
        EXPECT_EQ(outcome.status, 0) << arguments;
        EXPECT_EQ(outcome.out, "") << arguments;
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
        return outcome.err;
    }
};

TEST_F(Detect, pairs_go_to_standard_output) { EXPECT_EQ(pairs("five.off"), five_pairs); }

TEST_F(Detect, pairs_of_two_files_name_the_first_file_first) {
    EXPECT_EQ(pairs("five.off two.off"), "0 1\n2 0\n3 1\n4 0\n");
}

TEST_F(Detect, stream_has_the_same_lines_as_the_list) {
    for (const std::string input :
         {"five.off", "five.off two.off", "five.off --contacts", "five.off --memory-limit 1MB"}) {
        EXPECT_EQ(sorted_lines(pairs(input + " --stream")), sorted_lines(pairs(input)));
        for (const std::string out : {"pairs.txt", "pairs.csv"}) {
            const std::string streamed = summary(input + " --stream -o streamed_" + out);
            const std::string expected = summary(input + " -o " + out);
            EXPECT_EQ(streamed.substr(0, streamed.rfind(',')), expected.substr(0, expected.rfind(',')));
            EXPECT_EQ(sorted_lines(read("streamed_" + out)), sorted_lines(read(out))) << input;
        }
    }
}

TEST_F(Detect, only_one_list_of_pairs_can_be_streamed) {
    for (const std::string bad :
         {"-o a.json", "-o a.glb", "-o a.txt -o b.txt", "--check", "--polygons", "--part 1/2"}) {
        const Outcome outcome = crumple("detect five.off --stream " + bad);
        EXPECT_EQ(outcome.status, 2) << bad;
        EXPECT_NE(outcome.err.find("--stream"), std::string::npos) << outcome.err;
    }
}

TEST_F(Detect, adjacent_triangles_are_skipped_on_request) {
    EXPECT_EQ(pairs("five.off --neighbours skip"), "0 1\n0 3\n");
    EXPECT_EQ(pairs("five.off --neighbours geometric"), five_pairs);
}

TEST_F(Detect, kind_proper_excludes_touches_and_folds) {
    EXPECT_EQ(pairs("five.off --kind proper"), "0 1\n");
    EXPECT_EQ(pairs("five.off --kind all"), five_pairs);
}

TEST_F(Detect, weld_merges_vertices_of_touching_corners) {
    EXPECT_EQ(pairs("five.off --weld"), "0 1\n2 4\n");
    EXPECT_EQ(pairs("five.off --no-weld"), five_pairs);
    EXPECT_EQ(pairs("five.off two.off --weld"), "2 0\n4 0\n");
}

TEST_F(Detect, stl_is_welded_by_default) {
    write("hinge.stl",
          "solid\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
          "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 1\nendloop\nendfacet\nendsolid\n");
    EXPECT_EQ(pairs("hinge.stl"), "");
    EXPECT_EQ(pairs("hinge.stl --no-weld"), "0 1\n");
}

TEST_F(Detect, precision_decides_whether_triangles_touch) {
    EXPECT_EQ(pairs("near.off"), "");
    EXPECT_EQ(pairs("near.off --precision float64"), "");
    EXPECT_EQ(pairs("near.off --precision float32"), "0 1\n");
}

TEST_F(Detect, contacts_are_listed_on_the_line_of_their_pair) {
    EXPECT_EQ(pairs("five.off --contacts"),
              "0 1 segment 1 1 0 2 2 0\n0 3 point 0 0 0\n2 4 area 10 0 0 14 0 0 11 3 0\n");
}

TEST_F(Detect, groups_can_be_components) {
    EXPECT_EQ(pairs("five.off --groups components --filter between"), "0 1\n0 3\n");
    EXPECT_EQ(pairs("five.off --groups components --filter within"), "2 4\n");
    EXPECT_EQ(pairs("five.off --groups components --filter both"), five_pairs);
    EXPECT_EQ(pairs("five.off --groups components --filter between --weld"), "0 1\n");
}

TEST_F(Detect, components_of_two_files_are_distinct) {
    EXPECT_EQ(pairs("five.off two.off --groups components --filter within"), "");
    EXPECT_EQ(pairs("five.off two.off --groups components --filter between"), "0 1\n2 0\n3 1\n4 0\n");
    // Each component of the one copy meets the same component of the other.
    EXPECT_EQ(pairs("five.off five.off --groups components --filter within"), "");
    EXPECT_EQ(pairs("five.off five.off --groups components --filter between"), pairs("five.off five.off"));
}

TEST_F(Detect, groups_can_come_from_a_file) {
    write("groups.txt", "0\n0\n1\n1\n0\n");
    EXPECT_EQ(pairs("five.off --groups groups.txt --filter between"), "0 3\n2 4\n");
    EXPECT_EQ(pairs("five.off --groups groups.txt --filter within"), "0 1\n");
    write("seven.txt", "0\r\n0\r\n1\r\n1\r\n0\r\n1\r\n-7\r\n");
    EXPECT_EQ(pairs("five.off two.off --groups seven.txt --filter within"), "2 0\n");
}

TEST_F(Detect, groups_can_be_a_ply_property) {
    write("parts.ply",
          "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n"
          "element face 3\nproperty list uchar int vertex_indices\nproperty int part\nend_header\n"
          "0 0 0\n4 0 0\n0 4 0\n1 1 -1\n1 1 1\n3 3 0.5\n3 0 1 2 8\n3 3 4 5 9\n3 2 1 0 8\n");
    EXPECT_EQ(pairs("parts.ply"), "0 1\n0 2\n1 2\n");
    EXPECT_EQ(pairs("parts.ply --groups part --filter between"), "0 1\n1 2\n");
    EXPECT_EQ(pairs("parts.ply --groups part --filter within"), "0 2\n");
}

TEST_F(Detect, backends_threads_and_clusters_give_the_same_pairs) {
    ASSERT_EQ(crumple("make bodies --triangles 3000 -o bodies.ply").status, 0);
    const std::string result = pairs("bodies.ply");
    ASSERT_GT(std::count(result.begin(), result.end(), '\n'), 100);
    for (const char* option : {"--backend reference", "--backend cpu", "--backend auto", "--threads 1", "--threads 7",
                               "--clusters 1", "--clusters 64", "--memory-limit 1GiB"}) {
        EXPECT_EQ(pairs(std::string("bodies.ply ") + option), result) << option;
    }
}

TEST_F(Detect, parts_together_give_the_whole_result) {
    ASSERT_EQ(crumple("make soup --triangles 20000 -o soup.ply").status, 0);
    std::vector<std::string> lines;
    for (const char* part : {"3/3", "1/3", "2/3"}) {
        std::istringstream in(pairs(std::string("soup.ply --part ") + part));
        std::size_t before = lines.size();
        for (std::string line; std::getline(in, line);) lines.push_back(line);
        EXPECT_GT(lines.size(), before) << part;
    }
    std::istringstream in(pairs("soup.ply"));
    std::vector<std::string> whole;
    for (std::string line; std::getline(in, line);) whole.push_back(line);
    std::sort(lines.begin(), lines.end());
    std::sort(whole.begin(), whole.end());
    EXPECT_EQ(lines, whole);
    EXPECT_EQ(pairs("five.off two.off --part 1/1"), pairs("five.off two.off"));
}

TEST_F(Detect, pairs_are_written_in_every_format) {
    EXPECT_TRUE(summary("five.off -o p.txt -o p.csv -o p.json -o p.npz").starts_with("3 pairs, 5 of 5 triangles, "));
    EXPECT_EQ(read("p.txt"), five_pairs);
    EXPECT_EQ(read("p.csv"), "a,b\n0,1\n0,3\n2,4\n");
    const auto json = nlohmann::json::parse(read("p.json"));
    EXPECT_EQ(json["pairs"].dump(), "[[0,1],[0,3],[2,4]]");
    EXPECT_EQ(json["statistics"]["pairs"], 3);
    EXPECT_TRUE(read("p.npz").starts_with("PK"));
    EXPECT_TRUE(contains(read("p.npz"), "pairs.npy"));
    EXPECT_EQ(crumple("verify five.off p.npz").status, 0);
}

TEST_F(Detect, contacts_are_written_to_csv_and_json) {
    summary("five.off --contacts --output p.csv -o p.json");
    for (const char* row :
         {"\n0,1,segment,2,1,1,0,2,2,0,", "\n0,3,point,1,0,0,0,", "\n2,4,area,3,10,0,0,14,0,0,11,3,0,"})
        EXPECT_TRUE(contains(read("p.csv"), row)) << row;
    EXPECT_EQ(nlohmann::json::parse(read("p.json"))["contacts"].dump(),
              R"([{"kind":"segment","points":[[1,1,0],[2,2,0]]},{"kind":"point","points":[[0,0,0]]},)"
              R"({"kind":"area","points":[[10,0,0],[14,0,0],[11,3,0]]}])");
}

TEST_F(Detect, coloured_meshes_are_written) {
    EXPECT_TRUE(summary("-o c.ply -o c.obj -o c.glb five.off two.off").starts_with("4 pairs, 6 of 7 triangles, "));
    EXPECT_EQ(io::read_mesh(file("c.ply")).triangle_count(), 7);
    EXPECT_TRUE(contains(read("c.ply"), "property uchar red"));
    EXPECT_EQ(io::read_mesh(file("c.obj")).triangle_count(), 7);
    EXPECT_TRUE(contains(read("c.obj"), "usemtl colliding\n"));
    EXPECT_TRUE(contains(read("c.mtl"), "newmtl colliding\nKd "));
    EXPECT_TRUE(read("c.glb").starts_with("glTF"));
    EXPECT_TRUE(contains(read("c.glb"), "\"colliding\""));
}

TEST_F(Detect, check_reports_collisions_by_exit_status) {
    EXPECT_EQ(crumple("detect five.off --check").status, 1);
    EXPECT_EQ(crumple("detect five.off --check").out, "something collides\n");
    EXPECT_EQ(crumple("detect near.off --check").out, "nothing collides\n");
    for (const char* options : {"", " --stats", " --part 1/1", " --polygons", " --backend reference"}) {
        const Outcome outcome = crumple(std::string("detect five.off two.off --check") + options);
        EXPECT_EQ(outcome.status, 1) << options;
        EXPECT_EQ(outcome.out, "something collides\n") << options;
    }
    EXPECT_EQ(crumple("detect five.off --check -o p.txt").status, 1);
    EXPECT_EQ(read("p.txt"), five_pairs);
    EXPECT_EQ(crumple("detect near.off --check").status, 0);
}

TEST_F(Detect, written_list_gives_a_summary_of_one_line) {
    EXPECT_TRUE(summary("near.off -o p.txt").starts_with("nothing collides: 2 triangles, "));
    write("one.off", "OFF\n6 2 0\n0 0 0\n2 0 0\n0 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 3 4 5\n");
    EXPECT_TRUE(summary("one.off -o p.txt").starts_with("1 pair, 2 of 2 triangles, "));
    EXPECT_FALSE(contains(crumple("detect one.off -o p.txt --stats").err, "1 pair,"));
}

TEST_F(Detect, html_page_has_pair_count_and_entries_for_meshes_and_contacts) {
    summary("five.off two.off --contacts -o p.html");
    const std::string page = read("p.html");
    EXPECT_TRUE(page.starts_with("<!DOCTYPE html>"));
    EXPECT_TRUE(page.ends_with("</html>\n"));
    EXPECT_TRUE(contains(page, "4 colliding pairs of 7 triangles"));
    for (const char* entry : {"first mesh: collides", "first mesh: free", "second mesh: collides", "contact"})
        EXPECT_TRUE(contains(page, entry)) << entry;
    EXPECT_FALSE(contains(page, "@ID@") || contains(page, "@DATA@"));
}

TEST_F(Detect, pairs_of_polygons_are_listed) {
    // Two squares that cross, each cut in two, and a triangle that touches the first.
    write("squares.obj",
          "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 1 -1 -1\nv 1 3 -1\nv 1 3 1\nv 1 -1 1\nv 9 0 0\nv 9 1 0\nv 2 1 0\n"
          "f 1 2 3 4\nf 5 6 7 8\nf 9 10 11\n");
    EXPECT_EQ(pairs("squares.obj"), "0 2\n0 3\n0 4\n1 2\n1 3\n");
    EXPECT_EQ(pairs("squares.obj --polygons"), "0 1\n0 2\n");
    EXPECT_EQ(pairs("squares.obj squares.obj --polygons"), "0 0\n0 1\n0 2\n1 0\n1 1\n2 0\n2 2\n");
    EXPECT_TRUE(summary("squares.obj --polygons -o c.ply -o c.obj -o c.html -o c.glb -o c.json")
                    .starts_with("2 pairs, 3 of 3 polygons, "));
    EXPECT_TRUE(contains(read("c.ply"), "element face 3"));
    EXPECT_TRUE(contains(read("c.obj"), "usemtl colliding\nf 1 2 3 4\nf 5 6 7 8\nf 9 10 11\n")) << read("c.obj");
    EXPECT_TRUE(contains(read("c.html"), "2 colliding pairs of 3 polygons"));
    EXPECT_EQ(io::read_mesh(file("c.ply")).polygons.count(), 3);
    EXPECT_EQ(shell("$crumple detect squares.obj --polygons | $crumple verify squares.obj - --polygons").status, 0);
    write("folded.obj", "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 4 0 0.5\nv 1 1 -1\nv 1 1 1\nv 3 3 0\nf 5 6 7\nf 1 2 3\n");
    EXPECT_EQ(pairs("folded.obj --polygons"), "0 1\n");
    const Outcome contacts = crumple("detect squares.obj --polygons --contacts");
    EXPECT_EQ(contacts.status, 2);
    EXPECT_TRUE(contains(contacts.err, "--contacts does not go with --polygons: contacts belong to triangles"))
        << contacts.err;
    EXPECT_EQ(crumple("detect squares.obj --polygons --part 1/2").status, 2);
}

TEST_F(Detect, polygon_can_collide_with_itself) {
    write("bow.obj", "v 0 0 0\nv 3 3 0\nv 3 0 0\nv 0 3 0\nf 1 2 3 4\n");
    const Outcome fan = crumple("detect bow.obj --polygons");
    EXPECT_EQ(fan.out, "0 0\n");
    EXPECT_EQ(fan.err, "crumple: warning: bow.obj, line 5: a polygon crosses itself and becomes a fan\n");
    EXPECT_EQ(crumple("detect bow.obj --strict").status, 2);
}

TEST_F(Detect, concave_polygons_are_triangulated_by_ears_or_fan) {
    write("chevron.obj", "v 4 -2 0\nv 1 0 0\nv 4 2 0\nv 0 0 0\nf 1 2 3 4\n");
    EXPECT_EQ(pairs("chevron.obj"), "");
    EXPECT_EQ(pairs("chevron.obj --triangulation ears"), "");
    EXPECT_EQ(pairs("chevron.obj --triangulation fan"), "0 1\n");
}

TEST_F(Detect, each_warning_is_printed_on_one_line) {
    write("odd.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nseam 1 2\nseam 2 3\n");
    const Outcome outcome = crumple("detect odd.obj");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.err.substr(0, outcome.err.find("nothing collides: 0 triangles")),
              "crumple: warning: odd.obj, line 4: the unknown statement 'seam' is skipped, and 1 more like it\n"
              "crumple: warning: odd.obj: it holds no triangles\n");
    EXPECT_EQ(crumple("info odd.obj --strict").status, 2);
}

TEST_F(Detect, statistics_go_to_standard_error) {
    const Outcome outcome = crumple("detect five.off --stats");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.out, five_pairs);
    for (const char* row : {"bounds", "subdivide", "align", "sort", "sweep", "narrow", "output", "wall clock", "share",
                            "clusters", "members", "interval tests", "box overlaps", "edge tests", "double tests",
                            "exact tests", "pairs                        3  5 triangles collide", "peak memory"}) {
        EXPECT_TRUE(contains(outcome.err, row)) << row << " in\n" << outcome.err;
    }
}

TEST_F(Detect, progress_prints_each_step) {
    const auto steps = [&](const std::string& arguments) {
        std::istringstream lines(crumple("detect five.off --progress " + arguments).err);
        std::string all;
        double seconds = 0, before = 0;
        for (std::string unit, step; lines >> seconds >> unit && std::getline(lines, step);) {
            EXPECT_EQ(unit, "s");
            EXPECT_GE(std::exchange(before, seconds), 0);
            EXPECT_LE(before, seconds);
            all += step + ",";
        }
        return all;
    };
    EXPECT_EQ(steps(""), "  read,  search,  write,");
    EXPECT_EQ(steps("--check"), "  read,  search,");
    EXPECT_EQ(steps("--stream"), "  read,  search and write,");
    EXPECT_EQ(steps("--groups bodies"), "  read,  search,  write,");
    EXPECT_EQ(crumple("detect five.off").err, "");
}

TEST_F(Detect, memory_errors_name_limits_to_try_until_one_suffices) {
    ASSERT_EQ(crumple("make bodies --triangles 3000 -o bodies.ply").status, 0);
    std::string limit = "1000";
    for (int tries = 0; tries < 20; ++tries) {
        const Outcome outcome = crumple("detect bodies.ply --memory-limit " + limit);
        if (outcome.status != 3) break;
        EXPECT_EQ(outcome.out, "");
        EXPECT_TRUE(is_error_line(outcome.err)) << outcome.err;
        EXPECT_TRUE(contains(outcome.err, "crumple: bodies.ply: ")) << outcome.err;
        EXPECT_TRUE(contains(outcome.err, "of " + limit + " bytes is too small; at least ")) << outcome.err;
        const std::size_t place = outcome.err.find("; try ");
        ASSERT_NE(place, std::string::npos) << outcome.err;
        const std::int64_t next = std::stoll(outcome.err.substr(place + 6));
        EXPECT_GE(next, 2 * std::stoll(limit)) << "a limit that is followed does not lead to a slightly larger one";
        limit = std::to_string(next);
    }
    EXPECT_NE(limit, "1000");
    EXPECT_EQ(pairs("bodies.ply --memory-limit " + limit), pairs("bodies.ply"));
}

TEST_F(Detect, fuzzy_c_means_settings_change_no_result) {
    ASSERT_EQ(crumple("make bodies --triangles 3000 -o bodies.ply").status, 0);
    const std::string settings = "fuzziness=1.5,max_iterations=0,first_iterations=1,stop=0.5,first_stop=0.5";
    EXPECT_EQ(pairs("bodies.ply --fuzzy-c-means " + settings), pairs("bodies.ply"));
}

TEST_F(Detect, sweep_directions_and_leaf_sizes_change_no_result) {
    ASSERT_EQ(crumple("make bodies --triangles 3000 -o bodies.ply").status, 0);
    const std::string expected = pairs("bodies.ply");
    for (const char* const option : {"--sweep pca", "--sweep x", "--sweep y", "--sweep z", "--sweep 1,-2,0.5",
                                     "--leaf-size 50", "--leaf-size 100 --sweep 0,0,7 --membership ball"})
        EXPECT_EQ(pairs(std::string("bodies.ply ") + option), expected) << option;
}

TEST_F(Detect, membership_that_loses_pairs_is_reported) {
    // Two triangles whose tips cross, far from both of their centroids, which are the centres of the two clusters.
    write("cross.off", "OFF\n6 2 0\n-2 -0.1 0\n-2 0.1 0\n0.25 0 0\n2 0 -0.1\n2 0 0.1\n-0.25 0 0\n3 0 1 2\n3 3 4 5\n");
    const std::string detect = "detect cross.off --clusters 2 --fuzzy-c-means first_iterations=0";
    const char* const warning = "crumple: warning: pairs may be missing";
    EXPECT_EQ(crumple(detect).out, "0 1\n");
    for (const char* const rule : {"equation_5", "threshold=1"}) {
        const std::string by_rule = detect + " --membership " + rule;
        const Outcome outcome = crumple(by_rule);
        EXPECT_EQ(outcome.status, 0);
        EXPECT_EQ(outcome.out, "");
        EXPECT_TRUE(outcome.err.starts_with(warning)) << outcome.err;
        EXPECT_TRUE(crumple(by_rule + " --check").err.starts_with(warning));
        EXPECT_TRUE(contains(crumple(by_rule + " --stats").err, "; pairs may be missing\n"));
        EXPECT_TRUE(crumple(by_rule + " --stream").err.starts_with(warning));
        EXPECT_EQ(crumple(by_rule + " -o p.json").status, 0);
        EXPECT_TRUE(contains(read("p.json"), "\"complete\": false")) << read("p.json");
    }
    const Outcome all_clusters = crumple(detect + " --membership threshold=0");
    EXPECT_EQ(all_clusters.out, "0 1\n");
    EXPECT_EQ(all_clusters.err, "");
    const Outcome near = crumple(
        "near cross.off --radius 0.01 --clusters 2 --fuzzy-c-means first_iterations=0 "
        "--membership equation_5");
    EXPECT_TRUE(near.err.starts_with(warning)) << near.err;
}

TEST_F(Detect, wrong_settings_of_the_method_are_refused) {
    for (const auto& [option, message] :
         {std::pair{"--sweep w", "--sweep: w is not one of pca|x|y|z"},
          {"--sweep 1,2", "--sweep: pca, x, y, z or three numbers are expected"},
          {"--sweep 1,x,2", "--sweep: x is not a number"},
          {"--sweep 0,0,0", "a direction must not be 0"},
          {"--membership balls", "--membership balls: ball, equation_5 or threshold=U is expected"},
          {"--membership threshold=2", "a number from 0 to 1 is expected"},
          {"--leaf-size 0", "0 is not an integer from 1 to"},
          {"--backend reference --sweep x", "--sweep and --membership do not apply to --backend reference"},
          {"--backend reference --leaf-size 5", "--leaf-size does not apply to --backend reference"}}) {
        const Outcome outcome = crumple(std::string("detect five.off ") + option);
        EXPECT_EQ(outcome.status, 2) << option;
        EXPECT_TRUE(contains(outcome.err, message)) << outcome.err;
    }
}

TEST_F(Detect, memory_limit_accepts_units) {
    for (const char* size : {"1GiB", "500MB", "'1.5 g'", "700kib", "1T", "100000000", "100000000B"}) {
        EXPECT_EQ(pairs(std::string("five.off --memory-limit ") + size), five_pairs) << size;
    }
}

}  // namespace
}  // namespace crumple::cli::test
