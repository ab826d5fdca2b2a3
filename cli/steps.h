#pragma once

// Progress of a command, step by step (--progress).

#include <chrono>
#include <string_view>

namespace CLI {
class App;
}

namespace crumple::cli {

/// Prints a line to standard error as each step begins, with the seconds that have passed: "    12.31 s  search".
/// Prints lines instead of a bar, since mpirun forwards output that is not a terminal.
class Steps {
   public:
    explicit Steps(bool shown) : shown_(shown) {}

    void begin(std::string_view step) const;

   private:
    bool shown_;
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/// Adds `--progress`.
void add_progress_option(CLI::App& app, bool& shown);

}  // namespace crumple::cli
