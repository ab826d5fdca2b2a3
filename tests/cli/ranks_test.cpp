// Compares runs on several MPI ranks with one process: every list has the same bytes, and each message is printed once.

#include <array>
#include <bit>
#include <nlohmann/json.hpp>
#include <sstream>

#include "io/bytes/bytes.h"
#include "moving.h"

namespace crumple::cli::test {
namespace {

class Ranks : public Cli {
   protected:
    Ranks() {
        // Let Open MPI run as root and with more ranks than cores, and let waiting ranks yield.
        for (const char* const name : {"OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM",
                                       "OMPI_MCA_rmaps_base_oversubscribe", "OMPI_MCA_mpi_yield_when_idle"})
            setenv(name, "1", 1);
        setenv("OMPI_MCA_hwloc_base_binding_policy", "none", 1);
        setenv("OMPI_MCA_odls_base_sigkill_timeout", "0", 1);  // do not wait: all ranks end after a failure
        setenv("OMPI_MCA_btl_vader_single_copy_mechanism", "none", 1);
        setenv("OMPI_MCA_pml", "ob1", 1);             // searches no network: halves the start time
        setenv("LSAN_OPTIONS", "detect_leaks=0", 1);  // Open MPI leaks memory
        write("five.off", five_off);
    }

    Outcome ranks(int count, const std::string& arguments, const std::string& around = {}) const {
        return shell(around + " " CRUMPLE_MPIEXEC " " CRUMPLE_MPIEXEC_NUMBER " " + std::to_string(count) +
                     " $crumple " + arguments);
    }
    void make(const std::string& scene, const std::string& name) const {
        EXPECT_EQ(crumple("make " + scene + " -o " + name).status, 0);
    }

    /// Expects every list of 2 and 3 ranks to equal that of one process. `command` is detect by default.
    void expect_same(const std::string& arguments) const { expect_same("detect", arguments); }
    void expect_same(const std::string& command, const std::string& arguments) const {
        const std::string lists = " -o NAME.txt -o NAME.csv -o NAME.npz -o NAME.json -o - --format csv";
        const auto named = [&](const std::string& name) {
            std::string text = lists;
            for (std::size_t at; (at = text.find("NAME")) != text.npos;) text.replace(at, 4, name);
            return command + ' ' + arguments + text;
        };
        const Outcome one = crumple(named("one"));
        ASSERT_EQ(one.status, 0) << one.err;
        EXPECT_TRUE(command == "detect" || !read("one.txt").empty()) << arguments;
        for (const int count : {2, 3}) {
            const std::string what = command + ' ' + arguments + ", " + std::to_string(count) + " ranks";
            const Outcome outcome = ranks(count, named("ranks"));
            EXPECT_EQ(outcome.status, 0) << what << outcome.err;
            EXPECT_EQ(outcome.out, one.out) << what;
            EXPECT_EQ(without_time(outcome.err), without_time(one.err)) << what;
            for (const std::string end : {".txt", ".csv", ".npz"})
                EXPECT_TRUE(read("ranks" + end) == read("one" + end)) << what << end;
            nlohmann::json expected = nlohmann::json::parse(read("one.json")),
                           found = nlohmann::json::parse(read("ranks.json"));
            for (const char* same : {"pairs", "triangles"})
                EXPECT_EQ(found["statistics"][same], expected["statistics"][same]);
            expected.erase("statistics"), found.erase("statistics");
            EXPECT_TRUE(found == expected) << what;
        }
    }
    static std::string without_time(const std::string& summary) { return summary.substr(0, summary.rfind(',')); }

    /// Expects two ranks to fail with `status` and to print one error message that contains `reason`.
    void expect_refused(const std::string& arguments, const std::string& reason, int status = 2) const {
        const Outcome outcome = ranks(2, arguments);
        EXPECT_EQ(outcome.status, status) << arguments;
        EXPECT_EQ(outcome.out, "") << arguments;
        EXPECT_TRUE(contains(outcome.err, reason)) << arguments << ": " << outcome.err;
        EXPECT_EQ(outcome.err.find("crumple: "), outcome.err.rfind("crumple: ")) << arguments << ": " << outcome.err;
    }
    void expect_as_one_process(const std::string& arguments) const {
        const Outcome one = crumple(arguments);
        EXPECT_TRUE(is_error_line(one.err)) << one.err;
        expect_refused(arguments, one.err, one.status);
    }
};

template <class T>
void add(std::string& bytes, T value, std::endian order) {
    auto its = io::little_endian(value);
    if (order == std::endian::big) std::reverse(its.begin(), its.end());
    bytes.append(its.data(), its.size());
}

/// Returns a binary PLY of three crossing sheets, each with a group of its own. `corners`: the number of corners that
/// is stored for the last face, which has three.
std::string sheets(std::endian order, std::uint8_t corners = 3) {
    constexpr int n = 9;
    std::string bytes = std::string("ply\nformat binary_") + (order == std::endian::big ? "big" : "little") +
                        "_endian 1.0\nelement vertex " + std::to_string(3 * n * n) +
                        "\nproperty double z\nproperty float x\nproperty float y\nelement face " +
                        std::to_string(6 * (n - 1) * (n - 1)) +
                        "\nproperty short sheet\nproperty list int uint vertex_indices\nend_header\n";
    for (int sheet = 0; sheet < 3; ++sheet)
        for (int i = 0; i < n * n; ++i) {
            const float x = static_cast<float>(i % n), y = static_cast<float>(i / n);
            add(bytes, 0.1 * (sheet - 1) * (static_cast<double>(x) - 4) * (static_cast<double>(y) + 0.25), order);
            add(bytes, x, order), add(bytes, y, order);
        }
    for (int sheet = 0; sheet < 3; ++sheet)
        for (int i = 0; i < (n - 1) * (n - 1); ++i) {
            const int first = sheet * n * n + i / (n - 1) * n + i % (n - 1);
            for (const auto& face :
                 {std::array{first, first + 1, first + n}, std::array{first + n + 1, first + n, first + 1}}) {
                const bool last = sheet == 2 && i == (n - 1) * (n - 1) - 1 && face[0] != first;
                add(bytes, static_cast<std::int16_t>(sheet), order),
                    add(bytes, last ? std::int32_t{corners} : 3, order);
                for (const int corner : face) add(bytes, static_cast<std::uint32_t>(corner), order);
            }
        }
    return bytes;
}

/// Returns the PLY with the first two corners of its last face swapped.
std::string turned(std::string ply) {
    std::swap_ranges(ply.end() - 12, ply.end() - 8, ply.end() - 8);
    return ply;
}

TEST_F(Ranks, ranks_read_little_endian_ply) {
    make("cloth --triangles 3000", "a.ply");
    expect_same("a.ply --contacts");
}

TEST_F(Ranks, ranks_read_big_endian_ply) {
    write("a.ply", sheets(std::endian::big));
    expect_same("a.ply --contacts");
}

TEST_F(Ranks, ranks_read_stl) {
    make("lattice --triangles 1000", "a.stl");
    expect_same("a.stl --contacts");
}

TEST_F(Ranks, ranks_read_obj_3mf_compressed_and_polygon_files) {
    make("lattice --triangles 1000", "a.obj");
    expect_same("a.obj --contacts");
    make("lattice --triangles 1000", "a.ply.gz");
    expect_same("a.ply.gz");
    EXPECT_EQ(crumple("convert a.obj a.3mf").status, 0);
    expect_same("a.3mf");
    write("quads.off",
          "OFF\n8 3 0\n0 0 0\n4 0 0\n4 4 0\n0 4 0\n1 1 -1\n2 1 1\n3 1 -1\n2 2 -1\n4 0 1 2 3\n3 4 5 6\n3 4 5 7\n");
    expect_same("quads.off");
}

TEST_F(Ranks, ranks_can_outnumber_triangles) {
    write("two.off", "OFF\n6 2 0\n0 0 0\n4 0 0\n0 4 0\n1 1 -1\n1 1 1\n3 3 0.5\n3 0 1 2\n3 3 4 5\n");
    expect_same("two.off");
    EXPECT_EQ(crumple("detect two.off -o one.txt").status, 0);
    std::string stl(80, ' ');
    add(stl, std::uint32_t{2}, std::endian::little);
    for (const float x : {0.f, 0.f, 0.f, 0.f, 0.f, 0.f, 4.f, 0.f, 0.f, 0.f, 4.f, 0.f}) add(stl, x, std::endian::little);
    add(stl, std::uint16_t{0}, std::endian::little);
    for (const float x : {0.f, 0.f, 0.f, 1.f, 1.f, -1.f, 1.f, 1.f, 1.f, 3.f, 3.f, 1.f})
        add(stl, x, std::endian::little);
    add(stl, std::uint16_t{0}, std::endian::little);
    write("two.stl", stl);
    expect_same("two.stl --contacts");
}

TEST_F(Ranks, ranks_accept_options_of_the_query) {
    write("a.ply", sheets(std::endian::little));
    for (const std::string options : {"--weld --contacts --neighbours skip", "--precision float32 --kind proper",
                                      "--groups sheet --filter between --threads 2"})
        expect_same("a.ply " + options);
    std::string groups;
    for (int i = 0; i < 3 * 128; ++i) groups += std::to_string(i % 5) + '\n';
    write("groups.txt", groups);
    expect_same("a.ply --groups groups.txt --filter within");
}

TEST_F(Ranks, ranks_list_the_same_near_pairs_as_one_process) {
    write("a.ply", sheets(std::endian::big));
    expect_same("near", "a.ply --radius 0.3");
    expect_same("near", "a.ply --radius 0.5 --below --precision float32 --groups sheet --filter between");
    make("lattice --triangles 1000", "a.obj");
    expect_same("near", "a.obj --radius 0.05");
}

// STL is welded: equal vertices are merged, which renumbers the others.
TEST_F(Ranks, ranks_number_stl_vertices_like_one_process) {
    make("cloth --triangles 1000", "a.stl");
    expect_same("near", "a.stl --radius 0.02 --threads 2");
}

TEST_F(Ranks, ranks_list_the_same_impacts_as_one_process) {
    make("cloth --triangles 3000 --frame 60", "a.ply");
    make("cloth --triangles 3000 --frame 61", "b.ply");
    expect_same("impacts", "a.ply b.ply");
    expect_same("impacts", "a.ply b.ply --first");
    expect_same("impacts", "a.ply b.ply --weld --min-distance 0.001 --min-distance-share 0.1 --backend cpu");
}

TEST_F(Ranks, ranks_list_impacts_of_obj_and_off_files) {
    make("cloth --triangles 1000 --frame 60", "a.ply");
    make("cloth --triangles 1000 --frame 61", "b.obj");
    expect_same("impacts", "a.ply b.obj");
    write("above.off", above_off), write("below.off", below_off);
    expect_same("impacts", "above.off below.off");
}

TEST_F(Ranks, ranks_print_pairs_in_the_order_of_one_process) {
    write("a.ply", sheets(std::endian::little));
    const Outcome one = crumple("detect a.ply"), two = ranks(2, "detect a.ply");
    EXPECT_EQ(two.status, 0);
    EXPECT_EQ(two.out, one.out);
    EXPECT_EQ(two.err, "");
    EXPECT_FALSE(one.out.empty());
}

TEST_F(Ranks, ranks_accept_a_mesh_on_standard_input) {
    EXPECT_EQ(ranks(2, "detect -", "cat five.off |").out, five_pairs);
}

TEST_F(Ranks, check_gives_one_line_and_one_exit_status_for_all_ranks) {
    const Outcome some = ranks(2, "detect five.off --check");
    EXPECT_EQ(some.status, 1);
    EXPECT_EQ(some.out, "something collides\n");
    write("none.off", "OFF\n3 1 0\n0 0 0\n4 0 0\n0 4 0\n3 0 1 2\n");
    const Outcome none = ranks(2, "detect none.off --check");
    EXPECT_EQ(none.status, 0);
    EXPECT_EQ(none.out, "nothing collides\n");
    const Outcome near = ranks(2, "near five.off --radius 0.5 --check");
    EXPECT_EQ(near.status, 1);
    EXPECT_EQ(near.out, "something is near\n");
    const Outcome free = ranks(2, "impacts none.off none.off --check");
    EXPECT_EQ(free.status, 0);
    EXPECT_EQ(free.out, "nothing touches\n");
}

TEST_F(Ranks, statistics_are_printed_once) {
    write("a.ply", sheets(std::endian::little));
    const Outcome outcome = ranks(2, "detect a.ply --stats -o a.txt");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.out, "");
    for (const char* word : {"query", "input", "members", "search", "rows", "2 ranks", "parts", "balance", "bytes sent",
                             "triangles collide"})
        EXPECT_TRUE(contains(outcome.err, word)) << word << outcome.err;
    EXPECT_EQ(outcome.err.find("balance"), outcome.err.rfind("balance"));
    EXPECT_TRUE(contains(ranks(2, "near a.ply --radius 0.3 --stats").err, "vertex-face"));
    EXPECT_TRUE(contains(ranks(2, "impacts a.ply a.ply --first --stats").err, "only the first was looked for"));
}

TEST_F(Ranks, progress_prints_each_phase) {
    make("cloth --triangles 300", "a.ply");
    const auto steps = [&](const std::string& arguments) {
        const Outcome outcome = ranks(3, arguments + " -o rows.txt --progress");
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        std::istringstream lines(outcome.err);
        std::string all, unit, step;
        for (double seconds = 0; lines >> seconds >> unit && std::getline(lines >> std::ws, step);)
            if (unit == "s" && !contains(step, " of ")) all += step + ",";
        return all;
    };
    const std::string all = "read,query,input,ids,place,members,memory,search,rows,output,write,";
    EXPECT_EQ(steps("detect a.ply"), all);
    EXPECT_EQ(steps("near a.ply --radius 0.1"), all);
    EXPECT_EQ(steps("impacts a.ply a.ply"), all);
}

TEST_F(Ranks, unsupported_options_are_refused) {
    expect_refused("detect five.off --groups components --filter within",
                   "--groups components is not supported on several ranks");
    expect_refused("detect five.off --groups bodies", "--groups bodies is not supported on several ranks");
    expect_refused("detect five.off five.off", "a second mesh is not supported on several ranks");
    expect_refused("detect five.off -o a.glb", "a coloured .glb is not supported on several ranks");
    expect_refused("detect five.off -o a.csv.gz", "-o a.csv.gz, a compressed file, is not supported on several ranks");
    expect_refused("detect five.off --part 1/2", "--part is not supported on several ranks");
    expect_refused("detect five.off --polygons", "--polygons is not supported on several ranks");
    expect_refused("detect five.off --stream", "--stream is not supported on several ranks");
    expect_refused("info five.off", "info is not supported on several ranks");
    for (const std::string option : {"--radii r.txt", "--radius 1 --rest five.off", "--radius 1 --rings 1",
                                     "--radius 1 --stream", "--radius 1 -o a.glb"})
        expect_refused("near five.off " + option, " is not supported on several ranks");
    expect_refused("near five.off five.off --radius 1", "a second mesh is not supported on several ranks");
    for (const std::string option :
         {"--triangle-pairs", "--candidates", "--stream", "-o a.glb", "--groups components --filter within"})
        expect_refused("impacts five.off five.off " + option, " is not supported on several ranks");
    write("rod.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 5 5\nf 1 2 3\nl 3 4\n");
    expect_refused("near rod.obj --radius 1", "a mesh with lines (l) is not supported on several ranks");
    expect_refused("impacts rod.obj rod.obj", "a mesh with lines (l) is not supported on several ranks");
}

TEST_F(Ranks, single_rank_accepts_options_that_several_do_not_support) {
    EXPECT_EQ(ranks(1, "detect five.off --part 1/1").out, five_pairs);
    const Outcome near = ranks(1, "near five.off --radius 0.5 --rings 1"),
                  alone = crumple("near five.off --radius 0.5 --rings 1");
    EXPECT_EQ(near.status, 0);
    EXPECT_EQ(near.out, alone.out);
}

TEST_F(Ranks, environment_variable_makes_each_rank_run_alone) {
    const Outcome outcome = ranks(2, "detect five.off --part 1/1", "CRUMPLE_MPI=0");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.out, std::string(five_pairs) + five_pairs);
}

TEST_F(Ranks, ranks_fail_like_one_process) {
    expect_as_one_process("detect missing.ply");
    expect_as_one_process("detect five.off --fast");
    expect_as_one_process("detect five.off --backend reference --clusters 2");
    expect_as_one_process("detect five.off -o a.foo");
    expect_as_one_process("detect five.off -o nowhere/a.txt");
    expect_as_one_process("detect five.off -o nowhere/a.npz");
    write("bad.txt", five_off);
    expect_as_one_process("detect bad.txt -o bad.txt");
    const std::string ply = sheets(std::endian::little);
    write("cut.ply", ply.substr(0, ply.size() - 5));
    expect_as_one_process("detect cut.ply");
    write("corners.ply", sheets(std::endian::little, 2));
    expect_as_one_process("detect corners.ply");
    write("quads.off", "OFF\n4 2 0\n0 0 0\n4 0 0\n4 4 0\n0 4 0\n3 0 1 2\n3 0 2 3\n");
    write("turned.ply", turned(ply));
    write("sheets.ply", ply);
    expect_as_one_process("near five.off");
    expect_as_one_process("near cut.ply --radius 1");
    expect_as_one_process("near missing.ply --radius 1 -o a.csv");
    expect_as_one_process("near five.off --radius 1 -o nowhere/a.csv");
    expect_as_one_process("near bad.txt --radius 1 -o bad.txt");
    expect_as_one_process("impacts five.off");
    expect_as_one_process("impacts five.off quads.off");
    expect_as_one_process("impacts sheets.ply five.off");
    expect_as_one_process("impacts sheets.ply turned.ply");
    expect_as_one_process("impacts sheets.ply cut.ply");
    expect_as_one_process("impacts - -");
    EXPECT_EQ(ranks(2, "near five.off --radius 1 --memory-limit 1000").status, 3);
    EXPECT_TRUE(contains(ranks(2, "detect five.off --memory-limit 1000").err, "five.off: rank "));
    EXPECT_EQ(ranks(2, "detect five.off --memory-limit 1000").status, 3);
}

/// Returns a box in OFF, of edge length 1, with all or fewer of its triangles.
std::string unit_box(double x, double y, int triangles = 12) {
    std::ostringstream out;
    out << "OFF\n8 " << triangles << " 0\n";
    for (int v = 0; v < 8; ++v) out << x + (v & 1) << ' ' << y + (v >> 1 & 1) << ' ' << (v >> 2) << '\n';
    constexpr std::array<const char*, 12> faces{"0 2 1", "1 2 3", "4 5 6", "5 7 6", "0 1 4", "1 5 4",
                                                "2 6 3", "3 6 7", "0 4 2", "2 4 6", "1 3 5", "3 7 5"};
    for (int t = 0; t < triangles; ++t) out << "3 " << faces[static_cast<std::size_t>(t)] << '\n';
    return out.str();
}

TEST_F(Ranks, ranks_find_overlaps_of_bodies) {
    std::string files;
    for (int b = 0; b < 7; ++b) {
        const std::string name = "box" + std::to_string(b) + ".off";
        write(name, unit_box(0.375 * b, b % 2 * 0.25));
        files += " " + name;
    }
    write("open.off", unit_box(0.5, 0, 11));
    expect_same("overlap", files.substr(0, files.rfind(' ')) + " --min-volume 0.01 --excluded-bodies box0,box2");
    expect_same("overlap", files + " open.off --open skip --self-overlaps");
    const std::string parts = files + " --regions --depth-tolerance 0.01 --withdraw 0,0,1 -o NAME.txt -o NAME.npz";
    const auto named = [&](std::string name) {
        std::string text = "overlap" + parts;
        for (std::size_t at; (at = text.find("NAME")) != text.npos;) text.replace(at, 4, name);
        return text;
    };
    EXPECT_EQ(crumple(named("one")).status, 0);
    EXPECT_EQ(ranks(3, named("ranks")).status, 0);
    for (const std::string end : {".txt", ".npz"}) {
        EXPECT_FALSE(read("one" + end).empty());
        EXPECT_TRUE(read("ranks" + end) == read("one" + end)) << end;
    }
    EXPECT_EQ(ranks(2, "overlap --check" + files).status, 1);
    EXPECT_EQ(ranks(2, "overlap --check box0.off box6.off").status, 0);
    EXPECT_TRUE(contains(ranks(2, "overlap --stats" + files).err, "wall clock"));
    expect_as_one_process("overlap box0.off open.off");
    expect_as_one_process("overlap box0.off missing.off");
    expect_as_one_process("overlap box0.off box1.off -o nowhere/a.csv");
    expect_refused("overlap box0.off box1.off --poses p.npy", "--poses is not supported on several ranks");
    expect_refused("overlap box0.off -", "standard input to overlap is not supported on several ranks");
}

TEST_F(Ranks, failure_before_writing_keeps_old_files_and_leaves_no_temporary_ones) {
    write("old.txt", "as it was\n");
    EXPECT_EQ(ranks(2, "detect missing.ply -o old.txt").status, 2);
    EXPECT_EQ(read("old.txt"), "as it was\n");
    EXPECT_EQ(ranks(2, "impacts five.off missing.ply -o old.txt").status, 2);
    EXPECT_EQ(read("old.txt"), "as it was\n");
    EXPECT_EQ(ranks(2, "detect five.off --memory-limit 1000 -o old.txt").status, 3);
    EXPECT_EQ(read("old.txt"), "as it was\n");
    EXPECT_EQ(ranks(2, "detect five.off -o old.txt -o nowhere/b.txt").status, 2);
    for (const auto& entry : fs::directory_iterator(file("."))) EXPECT_NE(entry.path().extension(), ".tmp");
}

}  // namespace
}  // namespace crumple::cli::test
