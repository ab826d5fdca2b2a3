#pragma once

// Standard output and standard error: terminal or pipe, colour or not.

#include <cstddef>
#include <functional>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/color.h>
#include <fmt/format.h>

#include "io/bytes/grouped.h"

namespace crumple::cli {

/// Calls write(out) with standard output. Throws Error (file) if not everything could be written; a closed pipe
/// (`crumple ... | head`) is no error.
void to_standard_output(const std::function<void(std::ostream&)>& write);

/// Suppresses all output to standard output and standard error. Used on MPI ranks other than rank 0.
void be_silent(bool silent = true);

/// Prints to standard error, like fmt::print. Ignores errors of the write.
void say(std::string_view text);
template <class... Args>
void say(fmt::format_string<Args...> format, Args&&... args) {
    say(std::string_view(fmt::format(format, std::forward<Args>(args)...)));
}
template <class... Args>
void say(fmt::text_style style, fmt::format_string<Args...> format, Args&&... args) {
    say(std::string_view(fmt::format(style, fmt::string_view(format), std::forward<Args>(args)...)));
}

/// Prints `crumple: message` in one line on standard error.
void print_error(std::string_view message);
/// Prints `crumple: note: message` in one line on standard error.
void print_note(std::string_view message);
/// Prints `crumple: warning: message` in one line on standard error.
void print_warning(std::string_view message);

/// Returns the style if the stream (1: standard output, 2: standard error) is a terminal and the environment variable
/// NO_COLOR is unset or empty; else no style.
fmt::text_style on_terminal(int stream, fmt::text_style style);

using io::grouped;
/// Returns a size in bytes as text with a binary unit: 12.3 MiB.
std::string readable_bytes(std::int64_t bytes);

/// Progress bar in the last line of a terminal; silent if standard error is not a terminal, or if there is only one
/// step.
class Progress {
   public:
    explicit Progress(std::size_t steps);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void show(std::size_t step, std::string_view text);
    void clear();

   private:
    std::size_t steps_;
    bool shown_;
};

}  // namespace crumple::cli
