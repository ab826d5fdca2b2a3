#include <csignal>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>
#include <vector>

#include "crumple/io.h"
#include "moving.h"

namespace crumple::cli::test {
namespace {

const std::string times_and_counts =
    "milliseconds,bounds,subdivide,align,sort,sweep,narrow,output,clusters,leaves,members,interval_tests,box_overlaps,"
    "edge_tests,double_tests,exact_tests,repeats,least,greatest";
const std::string header = "frame,triangles,pairs," + times_and_counts;

class Sequence : public Cli {
   protected:
    Sequence() {
        write("a.off", five_off);
        write("b,2.off", near_off);
    }
    static std::vector<std::string> lines(const std::string& text) {
        std::vector<std::string> result;
        std::istringstream in(text);
        for (std::string line; std::getline(in, line);) result.push_back(line);
        return result;
    }
    /// Starts a sequence of 5,000 frames, sends `signal` after the first rows, and returns the exit status.
    int interrupt(const std::string& output, const std::string& signal = "INT") const {
        EXPECT_EQ(crumple("make soup --triangles 5000 -o frame.ply").status, 0);
        std::string command = "exec $crumple sequence -o " + output;
        for (int i = 0; i < 5000; ++i) command += " frame.ply";
        std::thread keyboard([&] {
            while (lines(text_of(unfinished())).size() < 4) std::this_thread::sleep_for(std::chrono::milliseconds(5));
            EXPECT_EQ(std::system(("kill -" + signal + " $(cat " + file("pid").string() + ")").c_str()), 0);
        });
        const Outcome outcome = shell("{ trap - INT; echo $BASHPID >pid; " + command + "; } & wait $!");
        keyboard.join();
        EXPECT_EQ(contains(outcome.err, "interrupted after "), signal == "INT") << outcome.err;
        EXPECT_EQ(unfinished(), "") << "nothing hidden stays";
        return outcome.status;
    }

    /// Returns the path of the hidden file that is being written, or an empty string.
    std::string unfinished() const {
        for (const auto& entry : fs::directory_iterator(file("")))
            if (entry.path().filename().string().starts_with(".t.")) return entry.path().string();
        return "";
    }
};

TEST_F(Sequence, contacts_are_computed_on_request) {
    write("flat.off", "OFF\n6 2 0\n0 0 0\n2 0 0\n0 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 3 4 5\n");
    const Outcome outcome = crumple("sequence flat.off flat.off --contacts --stats");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(lines(outcome.out).size(), 3u);
    EXPECT_TRUE(contains(outcome.err, "contacts                     2  2 in rational numbers")) << outcome.err;
    EXPECT_EQ(crumple("detect flat.off --contacts -o flat.json").status, 0);
    EXPECT_TRUE(contains(text_of(file("flat.json").string()), "\"rational_contacts\": 1,"));
}

TEST_F(Sequence, each_frame_has_one_row) {
    const Outcome outcome = crumple("sequence a.off 'b,2.off' a.off");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.err, "");
    const auto rows = lines(outcome.out);
    ASSERT_EQ(rows.size(), 4u);
    EXPECT_EQ(rows[0], header);
    EXPECT_TRUE(rows[1].starts_with("a.off,5,3,")) << rows[1];
    EXPECT_TRUE(rows[2].starts_with("\"b,2.off\",2,0,")) << rows[2];
    EXPECT_TRUE(rows[3].starts_with("a.off,5,3,")) << rows[3];
    EXPECT_EQ(std::count(rows[1].begin(), rows[1].end(), ','), std::count(rows[0].begin(), rows[0].end(), ','));
}

TEST_F(Sequence, rows_are_written_as_csv_and_json) {
    EXPECT_EQ(crumple("sequence a.off 'b,2.off' -o t.csv").out, "");
    EXPECT_EQ(lines(read("t.csv")).size(), 3u);
    EXPECT_EQ(crumple("sequence a.off 'b,2.off' -o t.json").out, "");
    for (const std::string& text : {read("t.json"), crumple("sequence --json a.off 'b,2.off'").out}) {
        const auto json = nlohmann::json::parse(text);
        ASSERT_EQ(json.size(), 2u);
        EXPECT_EQ(json[0]["pairs"], 3);
        EXPECT_EQ(json[1]["frame"], "b,2.off");
        EXPECT_TRUE(json[1].contains("narrow"));
    }
}

TEST_F(Sequence, rows_have_counts_of_each_stage) {
    EXPECT_EQ(crumple("sequence a.off 'b,2.off' -o t.json --clusters 1").out, "");
    const auto rows = nlohmann::json::parse(read("t.json"));
    EXPECT_EQ(crumple("detect a.off -o p.json --clusters 1").status, 0);
    const auto statistics = nlohmann::json::parse(read("p.json"))["statistics"];
    for (const char* const count : {"clusters", "leaves", "members", "interval_tests", "box_overlaps", "edge_tests",
                                    "double_tests", "exact_tests"})
        EXPECT_EQ(rows[0][count], statistics[count]) << count;
    EXPECT_EQ(rows[0]["members"], 5);
    EXPECT_GE(rows[0]["box_overlaps"], 3);
    EXPECT_EQ(rows[1]["members"], 2);
    EXPECT_EQ(rows[0]["repeats"], 1);
    EXPECT_EQ(rows[0]["least"], rows[0]["milliseconds"]);
    EXPECT_EQ(rows[0]["greatest"], rows[0]["milliseconds"]);
}

TEST_F(Sequence, frames_are_searched_several_times_on_request) {
    EXPECT_EQ(crumple("sequence a.off 'b,2.off' --repeat 25 -o t.json -o t.csv -o c.ply --check").status, 1);
    const auto rows = nlohmann::json::parse(read("t.json"));
    ASSERT_EQ(rows.size(), 2u);
    for (const auto& row : rows) {
        EXPECT_EQ(row["repeats"], 25);
        EXPECT_LE(row["least"], row["milliseconds"]);
        EXPECT_LE(row["milliseconds"], row["greatest"]);
        EXPECT_LT(row["least"], row["greatest"]);
    }
    EXPECT_EQ(rows[0]["pairs"], 3);
    EXPECT_TRUE(contains(lines(read("t.csv"))[1], ",25,")) << read("t.csv");
    EXPECT_TRUE(fs::exists(file("c1.ply")));
    EXPECT_EQ(crumple("sequence a.off --repeat 0").status, 2);
}

TEST_F(Sequence, scene_can_be_named_instead_of_files) {
    const auto rows = lines(crumple("sequence --scene cutting --triangles 300").out);
    ASSERT_EQ(rows.size(), 121u);
    EXPECT_TRUE(rows[1].starts_with("0,")) << rows[1];
    EXPECT_TRUE(rows[120].starts_with("119,")) << rows[120];
    // A scene gives the same row as a file of its frame, also with groups and in another precision.
    EXPECT_EQ(crumple("make bodies --triangles 2000 --frame 7 -o b.ply").status, 0);
    for (const char* options : {"", " --groups group --filter between", " --groups components --filter within",
                                " --precision float64 --weld"}) {
        const std::string pairs = lines(crumple(std::string("sequence b.ply") + options).out)[1].substr(5, 12);
        const std::string row =
            lines(crumple(std::string("sequence --scene bodies --triangles 2000") + options).out)[8];
        EXPECT_EQ(row.substr(1, row.find(',', row.find(',', 2) + 1)), pairs.substr(0, pairs.find(',', 6)) + ",")
            << options;
    }
}

TEST_F(Sequence, meshes_are_one_file_per_frame_or_one_animation) {
    EXPECT_EQ(crumple("sequence a.off 'b,2.off' -o c.ply -o c.obj -o c.glb -o t.csv").out, "");
    EXPECT_EQ(lines(read("t.csv")).size(), 3u);
    EXPECT_EQ(io::read_mesh(file("c0.ply")).triangle_count(), 5);
    EXPECT_EQ(io::read_mesh(file("c1.ply")).triangle_count(), 2);
    EXPECT_EQ(io::read_mesh(file("c1.obj")).triangle_count(), 2);
    EXPECT_TRUE(contains(read("c1.obj"), "mtllib c1.mtl"));
    EXPECT_TRUE(read("c.glb").starts_with("glTF"));
    EXPECT_TRUE(contains(read("c.glb"), "\"animations\""));
    EXPECT_FALSE(fs::exists(file("c2.ply")));
}

TEST_F(Sequence, bad_frame_leaves_old_tables_and_animations_unchanged) {
    write("old.csv", "precious\n");
    write("old.glb", "precious\n");
    for (const char* const frames : {"missing.off a.off", "a.off missing.off", "a.off a.off missing.off"}) {
        EXPECT_EQ(crumple(std::string("sequence -o old.csv -o new.json -o old.glb ") + frames).status, 2);
        EXPECT_EQ(read("old.csv"), "precious\n");
        EXPECT_EQ(read("old.glb"), "precious\n");
        EXPECT_FALSE(fs::exists(file("new.json")));
    }
    EXPECT_EQ(crumple("sequence a.off -o old.csv").status, 0);
    EXPECT_EQ(lines(read("old.csv")).size(), 2u);
    EXPECT_EQ(std::distance(fs::directory_iterator(file("")), fs::directory_iterator()), 6) << "no hidden files";
}

TEST_F(Sequence, standard_output_accepts_csv_json_and_glb) {
    EXPECT_EQ(lines(crumple("sequence a.off a.off -o - --format csv").out).size(), 3u);
    EXPECT_EQ(nlohmann::json::parse(crumple("sequence a.off a.off -o - --format json -o t.csv").out).size(), 2u);
    EXPECT_TRUE(crumple("sequence a.off a.off -o - --format glb").out.starts_with("glTF"));
    EXPECT_EQ(lines(read("t.csv")).size(), 3u);
    for (const char* wrong :
         {"-o -", "-o - --format ply", "--format csv", "-o t.csv --format csv", "-o - -o - --format csv"})
        EXPECT_EQ(crumple(std::string("sequence a.off ") + wrong).status, 2) << wrong;
}

TEST_F(Sequence, wrong_arguments_are_refused) {
    for (const char* wrong :
         {"sequence", "sequence a.off --scene cloth", "sequence --scene clot", "sequence a.off --triangles 5",
          "sequence a.off --seed 2", "sequence a.off -o x.stl", "sequence a.off --json -o x.csv",
          "sequence --scene bodies --groups part", "sequence a.off -o no/where.csv"}) {
        const Outcome outcome = crumple(wrong);
        EXPECT_EQ(outcome.status, 2) << wrong;
        EXPECT_TRUE(is_error_line(outcome.err)) << wrong << ": " << outcome.err;
        EXPECT_EQ(outcome.out.find('\n'), outcome.out.rfind('\n')) << wrong;  // at most a header
    }
}

TEST_F(Sequence, options_of_detect_are_accepted) {
    EXPECT_TRUE(contains(crumple("sequence a.off --neighbours skip").out, "a.off,5,2,"));
    EXPECT_TRUE(contains(crumple("sequence a.off --kind proper --threads 1").out, "a.off,5,1,"));
    EXPECT_TRUE(contains(crumple("sequence a.off --groups components --filter within").out, "a.off,5,1,"));
    EXPECT_TRUE(contains(crumple("sequence 'b,2.off' --precision float32").out, ",2,1,"));
}

TEST_F(Sequence, check_reports_collisions_by_exit_status) {
    EXPECT_EQ(crumple("sequence 'b,2.off' a.off --check").status, 1);
    EXPECT_EQ(crumple("sequence 'b,2.off' 'b,2.off' --check").status, 0);
}

TEST_F(Sequence, statistics_are_summed_over_frames) {
    const std::string err = crumple("sequence a.off a.off --stats").err;
    EXPECT_TRUE(contains(err, "triangles                   10\n")) << err;
    EXPECT_TRUE(contains(err, "pairs                        6  10 triangles collide\n")) << err;
}

TEST_F(Sequence, rows_before_a_bad_frame_are_printed) {
    const Outcome outcome = crumple("sequence a.off missing.off a.off");
    EXPECT_EQ(outcome.status, 2);
    EXPECT_TRUE(is_error_line(outcome.err) && contains(outcome.err, "missing.off")) << outcome.err;
    EXPECT_EQ(lines(outcome.out).size(), 2u);
    EXPECT_EQ(nlohmann::json::parse(crumple("sequence --json a.off missing.off").out).size(), 1u);
}

TEST_F(Sequence, times_have_no_digits_beyond_the_microsecond) {
    for (const auto& row : nlohmann::json::parse(crumple("sequence --json a.off a.off").out))
        for (const char* key : {"milliseconds", "bounds", "subdivide", "align", "sort", "sweep", "narrow", "output"}) {
            ASSERT_TRUE(row.contains(key)) << key;
            const std::string time = row[key].dump();
            EXPECT_LE(time.size() - std::min(time.find('.'), time.size()), 4u) << key << ' ' << time;
        }
}

TEST_F(Sequence, ctrl_c_keeps_finished_rows) {
    EXPECT_EQ(interrupt("t.csv"), 130);
    const auto rows = lines(read("t.csv"));
    EXPECT_GE(rows.size(), 4u);
    EXPECT_LT(rows.size(), 5000u);
    EXPECT_EQ(rows.front(), header);
    EXPECT_EQ(std::count(rows.back().begin(), rows.back().end(), ','), std::count(header.begin(), header.end(), ','))
        << rows.back();
}

TEST_F(Sequence, termination_leaves_no_hidden_files) {
    write("t.csv", "precious\n");
    EXPECT_EQ(interrupt("t.csv", "TERM"), 128 + SIGTERM);
    EXPECT_EQ(read("t.csv"), "precious\n");
}

TEST_F(Sequence, ctrl_c_leaves_an_animation) {
    EXPECT_EQ(interrupt("t.csv -o t.glb"), 130);
    EXPECT_TRUE(contains(read("t.glb"), "\"animations\""));
}

TEST_F(Sequence, ctrl_c_leaves_valid_json) {
    EXPECT_EQ(interrupt("t.json"), 130);
    EXPECT_GE(nlohmann::json::parse(read("t.json")).size(), 3u);
}

TEST_F(Sequence, each_step_has_a_row_with_its_impact_count_and_earliest_time) {
    write("above.off", above_off);
    write("below.off", below_off);
    const Outcome outcome = crumple("sequence above.off above.off below.off --impacts");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.err, "");
    const auto rows = lines(outcome.out);
    ASSERT_EQ(rows.size(), 3u);
    EXPECT_EQ(rows[0], "frame,triangles,impacts,earliest," + times_and_counts);
    EXPECT_TRUE(rows[1].starts_with("above.off,2,0,,")) << rows[1];
    EXPECT_TRUE(rows[2].starts_with("above.off,2,1,0.5,")) << rows[2];
    EXPECT_EQ(std::count(rows[1].begin(), rows[1].end(), ','), std::count(rows[0].begin(), rows[0].end(), ','));

    EXPECT_EQ(crumple("sequence above.off above.off below.off --impacts --json --check").status, 1);
    EXPECT_EQ(crumple("sequence above.off above.off --impacts --check").status, 0);
    const auto json = nlohmann::json::parse(
        crumple("sequence above.off above.off below.off --impacts --min-distance 0.25 --json").out);
    ASSERT_EQ(json.size(), 2u);
    EXPECT_TRUE(json[0]["earliest"].is_null());
    EXPECT_EQ(json[1]["impacts"], 1);
    EXPECT_EQ(json[1]["earliest"], 0.375);
    const Outcome stats = crumple("sequence above.off below.off --impacts --stats");
    EXPECT_TRUE(contains(stats.err, "1  impacts of all steps")) << stats.err;
}

TEST_F(Sequence, impacts_option_accepts_a_scene) {
    const auto rows = lines(crumple("sequence --scene cloth --triangles 200 --impacts").out);
    ASSERT_GT(rows.size(), 2u);
    EXPECT_TRUE(rows[0].starts_with("frame,triangles,impacts,earliest,")) << rows[0];
    EXPECT_TRUE(rows[1].starts_with("0,")) << rows[1];
}

TEST_F(Sequence, wrong_arguments_of_impacts_are_refused) {
    write("above.off", above_off);
    const auto refused = [&](const std::string& arguments, const std::string& reason) {
        const Outcome outcome = crumple("sequence " + arguments);
        EXPECT_EQ(outcome.status, 2) << arguments;
        EXPECT_TRUE(is_error_line(outcome.err)) << outcome.err;
        EXPECT_TRUE(contains(outcome.err, reason)) << outcome.err;
    };
    refused("above.off --impacts", "--impacts needs two frames or more");
    refused("above.off a.off --impacts", "above.off and a.off must be one mesh at two times");
    refused("above.off above.off --min-distance 1",
            "--min-distance, --min-distance-share and --approaching-only need --impacts");
    refused("above.off above.off --impacts --contacts", "--contacts does not go with --impacts");
    refused("above.off above.off --impacts -o a.glb", "a.glb: with --impacts a sequence is written as .csv or .json");
}

}  // namespace
}  // namespace crumple::cli::test
