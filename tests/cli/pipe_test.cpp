// Among other programs: pipes that close early, full disks, terminals.

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

TEST_F(Pipe, ReaderThatLeavesEarlyIsNoError) {
    const Outcome outcome = shell("$crumple detect big.ply | head -n 1; exit ${PIPESTATUS[0]}");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.err, "");
    EXPECT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 1);
    EXPECT_EQ(shell("$crumple detect big.ply --check | head -n 1; exit ${PIPESTATUS[0]}").status, 1);
    const Outcome frames = shell("$crumple sequence big.ply big.ply big.ply | head -n 0; exit ${PIPESTATUS[0]}");
    EXPECT_EQ(frames.status, 0);
    EXPECT_EQ(frames.err, "");
}

TEST_F(Pipe, FullDiskIsAnError) {
    for (const char* command : {"detect five.off", "sequence five.off", "info five.off", "make --list", "--help",
                                "--version", "detect --help"}) {
        const Outcome outcome = shell(std::string("$crumple ") + command + " >/dev/full");
        EXPECT_EQ(outcome.status, 2) << command;
        EXPECT_TRUE(is_error_line(outcome.err)) << command << ": " << outcome.err;
        EXPECT_TRUE(contains(outcome.err, "No space left")) << command << ": " << outcome.err;
    }
}

// What is told on standard error may be lost; the work and the status may not.
TEST_F(Pipe, NobodyNeedsToReadStandardError) {
    for (const std::string nowhere : {"2>/dev/full", "2>&-", "2> >(true)"}) {
        EXPECT_EQ(shell("$crumple detect missing.off " + nowhere).status, 2) << nowhere;
        EXPECT_EQ(shell("$crumple detect five.off --threads nine " + nowhere).status, 2) << nowhere;
        EXPECT_EQ(shell("$crumple detect five.off --stats -o pairs.txt " + nowhere).status, 0) << nowhere;
        EXPECT_EQ(shell("cat pairs.txt; rm pairs.txt").out, five_pairs) << nowhere;
        EXPECT_EQ(shell("$crumple sequence five.off five.off --stats " + nowhere).status, 0) << nowhere;
    }
}

TEST_F(Pipe, ReadsAPipe) {
    EXPECT_EQ(shell("cat five.off | $crumple detect /dev/stdin").out, five_pairs);
    EXPECT_EQ(shell("$crumple detect five.off | $crumple verify five.off /dev/stdin").status, 0);
}

TEST_F(Pipe, ColourIsForTerminals) {
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
