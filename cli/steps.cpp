#include "cli/steps.h"

#include <CLI/CLI.hpp>

#include "cli/terminal.h"

namespace crumple::cli {

void Steps::begin(std::string_view step) const {
    if (!shown_) return;
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin_;
    say("{:9.2f} s  {}\n", passed.count(), step);
}

void add_progress_option(CLI::App& app, bool& shown) {
    app.add_flag("--progress", shown,
                 "Print a line to standard error as each step begins, with the elapsed seconds. On several ranks: the "
                 "phases of rank 0");
}

}  // namespace crumple::cli
