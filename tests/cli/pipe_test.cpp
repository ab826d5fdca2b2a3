// Tests of the command line among other programs: pipes that close early, full disks, terminals.

#include "run.h"

namespace crumple::cli::test {
namespace {

class Pipe : public Cli {
   protected:
    Pipe() {
        write("five.off", five_off);
        EXPECT_EQ(crumple("make lattice --triangles 20000 -o big.ply").status, 0);  // more pairs than a pipe holds
    }
};

TEST_F(Pipe, reader_that_closes_early_is_no_error) {
    const Outcome outcome = shell("$crumple detect big.ply | head -n 1; exit ${PIPESTATUS[0]}");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.err, "");
    EXPECT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 1);
    EXPECT_EQ(shell("$crumple detect big.ply --check | head -n 1; exit ${PIPESTATUS[0]}").status, 1);
    const Outcome frames = shell("$crumple sequence big.ply big.ply big.ply | head -n 0; exit ${PIPESTATUS[0]}");
    EXPECT_EQ(frames.status, 0);
    EXPECT_EQ(frames.err, "");
}

TEST_F(Pipe, full_disk_is_an_error) {
    for (const char* command : {"detect five.off", "sequence five.off", "info five.off", "make --list", "--help",
                                "--version", "detect --help"}) {
        const Outcome outcome = shell(std::string("$crumple ") + command + " >/dev/full");
        EXPECT_EQ(outcome.status, 2) << command;
        EXPECT_TRUE(is_error_line(outcome.err)) << command << ": " << outcome.err;
        EXPECT_TRUE(contains(outcome.err, "No space left")) << command << ": " << outcome.err;
    }
}

TEST_F(Pipe, file_size_limit_is_an_error_and_keeps_the_old_file) {
    write("old.ply", "precious");
    const Outcome outcome =
        shell("ulimit -f 16; $crumple detect big.ply -o old.ply; status=$?; ls -A >names; exit $status");
    EXPECT_EQ(outcome.status, 2);
    EXPECT_TRUE(is_error_line(outcome.err) && contains(outcome.err, "old.ply: File too large")) << outcome.err;
    EXPECT_EQ(read("old.ply"), "precious");
    EXPECT_FALSE(contains(read("names"), ".old.ply")) << read("names");
}

// Messages on standard error may be lost; results and the exit status may not.
TEST_F(Pipe, lost_standard_error_changes_no_result_or_status) {
    for (const std::string nowhere : {"2>/dev/full", "2>&-", "2> >(true)"}) {
        EXPECT_EQ(shell("$crumple detect missing.off " + nowhere).status, 2) << nowhere;
        EXPECT_EQ(shell("$crumple detect five.off --threads nine " + nowhere).status, 2) << nowhere;
        EXPECT_EQ(shell("$crumple detect five.off --stats -o pairs.txt " + nowhere).status, 0) << nowhere;
        EXPECT_EQ(shell("cat pairs.txt; rm pairs.txt").out, five_pairs) << nowhere;
        EXPECT_EQ(shell("$crumple sequence five.off five.off --stats " + nowhere).status, 0) << nowhere;
    }
}

TEST_F(Pipe, dev_stdin_can_be_read_as_a_file) {
    EXPECT_EQ(shell("cat five.off | $crumple detect /dev/stdin").out, five_pairs);
    EXPECT_EQ(shell("$crumple detect five.off | $crumple verify five.off /dev/stdin").status, 0);
}

TEST_F(Pipe, dash_means_standard_input_or_output) {
    EXPECT_EQ(shell("cat five.off | $crumple detect -").out, five_pairs);
    EXPECT_EQ(shell("cat five.off | $crumple detect five.off - --check").status, 1);
    EXPECT_EQ(shell("$crumple detect five.off | $crumple verify five.off -").status, 0);
    for (const std::string format : {"txt", "csv", "json", "npz"}) {
        const std::string list = "$crumple detect five.off -o - --format " + format;
        EXPECT_EQ(shell(list + " | $crumple verify five.off - --format " + format).status, 0) << format;
    }
    EXPECT_TRUE(contains(shell("cat five.off | $crumple info -").out, "triangles             5"));
    EXPECT_EQ(shell("cat five.off | $crumple sequence - --check >/dev/null").status, 1);
    EXPECT_EQ(shell("$crumple make lattice --triangles 20000 -o - --format ply | cmp - big.ply").status, 0);
    for (const char* format : {"txt", "csv", "json", "npz", "ply", "glb", "html"}) {
        const std::string name = std::string("out.") + format;
        EXPECT_EQ(shell("$crumple detect five.off -o " + name).status, 0);
        const Outcome outcome = shell(std::string("$crumple detect five.off -o - --format ") + format);
        EXPECT_EQ(outcome.err, "") << format;
        if (std::string(format) == "json" || std::string(format) == "html") {  // these contain times or generated names
            EXPECT_EQ(outcome.out.substr(0, 40), read(name).substr(0, 40));
        } else {
            EXPECT_TRUE(outcome.out == read(name)) << format;
        }
    }
    const Outcome bad = shell("printf 'OFF 1 1 0 x' | $crumple detect -");
    EXPECT_TRUE(contains(bad.err, "crumple: standard input, line 1: ")) << bad.err;
}

TEST_F(Pipe, only_terminals_get_colour) {
    const std::string escape = "\x1b[";
    EXPECT_FALSE(contains(crumple("detect five.off --stats").err, escape));
    EXPECT_FALSE(contains(crumple("detect missing.off").err, escape));
    EXPECT_FALSE(contains(crumple("sequence five.off five.off").err, escape));
    if (shell("command -v script").status != 0) GTEST_SKIP() << "needs script(1) to make a terminal";
    const auto on_terminal = [&](const std::string& command) {
        return shell("export NO_COLOR=; script -qec '" + command + "' /dev/null </dev/null").out;
    };
    const std::string executable = CRUMPLE_EXECUTABLE;
    EXPECT_TRUE(contains(on_terminal(executable + " detect missing.off"), escape));
    EXPECT_TRUE(contains(on_terminal(executable + " detect five.off --stats"), escape));
    EXPECT_FALSE(contains(on_terminal("NO_COLOR=1 " + executable + " detect missing.off"), escape));
    EXPECT_TRUE(contains(on_terminal(executable + " sequence five.off five.off"), "1/2 five.off"));
}

}  // namespace
}  // namespace crumple::cli::test
