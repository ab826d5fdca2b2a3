#pragma once

// Progress of a command, step by step (--progress).

#include <chrono>
#include <string_view>

namespace CLI {
class App;
}

namespace crumple::cli {

/// Printer of a line to standard error when a step begins, with the seconds since the command began: "    12.31 s
/// search". It prints lines, not a progress bar, because under mpirun the output is no terminal.
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
