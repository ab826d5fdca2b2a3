#pragma once

// --progress: what a command is at.

#include <chrono>
#include <string_view>

namespace CLI {
class App;
}

namespace crumple::cli {

/// Lines on standard error, one for each step as it begins, with the seconds that have gone by: "    12.31 s  search".
/// Lines and no bar, for what mpirun hands on is no terminal.
class Steps {
   public:
    explicit Steps(bool shown) : shown_(shown) {}

    void begin(std::string_view step) const;

   private:
    bool shown_;
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/// `--progress`.
void add_progress_option(CLI::App& app, bool& shown);

}  // namespace crumple::cli
