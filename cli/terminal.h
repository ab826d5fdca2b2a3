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

/// Calls write(out) and checks that everything arrives. A reader that has left (`crumple ... | head`) is no error.
/// Throws Error (file).
void to_standard_output(const std::function<void(std::ostream&)>& write);

/// From now on nothing is printed, to standard output or standard error: somebody else does.
void be_silent(bool silent = true);

/// To standard error, as fmt::print; where it cannot be written, nothing happens.
void say(std::string_view text);
template <class... Args>
void say(fmt::format_string<Args...> format, Args&&... args) {
    say(std::string_view(fmt::format(format, std::forward<Args>(args)...)));
}
template <class... Args>
void say(fmt::text_style style, fmt::format_string<Args...> format, Args&&... args) {
    say(std::string_view(fmt::format(style, fmt::string_view(format), std::forward<Args>(args)...)));
}

/// `crumple: message` in one line on standard error.
void print_error(std::string_view message);
/// `crumple: note: message` in one line on standard error.
void print_note(std::string_view message);
/// `crumple: warning: message` in one line on standard error.
void print_warning(std::string_view message);

/// The style where the stream (1 or 2) is a terminal and NO_COLOR is not set, else none.
fmt::text_style on_terminal(int stream, fmt::text_style style);

using io::grouped;
/// 12.3 MiB
std::string readable_bytes(std::int64_t bytes);

/// A bar in the last line of a terminal; silent where standard error is none.
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
