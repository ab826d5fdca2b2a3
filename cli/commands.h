#pragma once

// Subcommands and exit statuses.

#include <functional>

#include <CLI/CLI.hpp>

namespace crumple::cli {

enum Status : int {
    done = 0,
    collided = 1,  ///< --check and check: something was found (info: a body is no solid's surface); verify: the list is
                   ///< wrong
    failed = 2,    ///< wrong use, bad input, a file that cannot be written
    out_of_memory = 3,  ///< under --memory-limit the message has a lower bound on the bytes needed
    interrupted = 130   ///< sequence: ended by Ctrl-C
};

/// Subcommand that was added to the command line. run() is called after parsing.
struct Command {
    CLI::App* app;
    std::function<int()> run;
    bool on_ranks = false;  ///< true if MPI processes can share its work (ranks.h)
};

Command add_detect(CLI::App& app);
Command add_impacts(CLI::App& app);
Command add_near(CLI::App& app);
Command add_overlap(CLI::App& app);
Command add_sequence(CLI::App& app);
Command add_check(CLI::App& app);
Command add_info(CLI::App& app);
Command add_verify(CLI::App& app);
Command add_make(CLI::App& app);
Command add_convert(CLI::App& app);
Command add_clusters(CLI::App& app);

}  // namespace crumple::cli
