#pragma once

// Step in which triangle 1 falls through triangle 0: its corner is 1 above triangle 0 at the start and 1 below at the
// end.

#include "run.h"

namespace crumple::cli::test {

inline constexpr const char* above_off = "OFF\n6 2 0\n0 0 0\n4 0 0\n0 4 0\n1 1 1\n2 1 2\n1 2 2\n3 0 1 2\n3 3 4 5\n";
inline constexpr const char* below_off =
    "OFF\n6 2 0\n0 0 0\n4 0 0\n0 4 0\n1 1 -1\n2 1 0.5\n1 2 0.5\n3 0 1 2\n3 3 4 5\n";

class Moving : public Cli {
   protected:
    Moving() {
        write("above.off", above_off);
        write("below.off", below_off);
    }
    /// Returns standard output of a run. Expects success, and no message on standard error unless the list is empty.
    std::string list(const std::string& arguments) const {
        const Outcome outcome = crumple(arguments);
        EXPECT_EQ(outcome.status, 0) << arguments;
        EXPECT_TRUE(reports_empty_list(outcome)) << arguments << ": " << outcome.err;
        return outcome.out;
    }
    void expect_refused(const std::string& arguments, const std::string& reason) const {
        const Outcome outcome = crumple(arguments);
        EXPECT_EQ(outcome.status, 2) << arguments;
        EXPECT_EQ(outcome.out, "") << arguments;
        EXPECT_TRUE(is_error_line(outcome.err)) << arguments << ": " << outcome.err;
        EXPECT_TRUE(contains(outcome.err, reason)) << arguments << ": " << outcome.err;
    }
};

}  // namespace crumple::cli::test
