#include "cli/terminal.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <fmt/format.h>

#include "crumple/error.h"
#include "io/bytes/file_buffer.h"

namespace crumple::cli {

namespace {

bool is_silent = false;

}  // namespace

void be_silent(bool silent) { is_silent = silent; }

void to_standard_output(const std::function<void(std::ostream&)>& write) {
    if (is_silent) {
        std::ostream nowhere(nullptr);
        return write(nowhere);
    }
    io::FileBuffer buffer(STDOUT_FILENO);
    std::ostream out(&buffer);
    try {
        write(out);
        out.flush();
    } catch (const Error&) {
        out.flush();
        if (!buffer.reason()) throw;
    }
    if (buffer.reason() && buffer.reason() != EPIPE) {
        throw Error(ErrorCode::file, std::string("cannot write to standard output: ") + std::strerror(buffer.reason()));
    }
}

void say(std::string_view text) {
    if (is_silent) return;
    std::fwrite(text.data(), 1, text.size(), stderr);
    std::fflush(stderr);
}

namespace {

void print_line(std::string_view title, fmt::terminal_color colour, std::string_view message) {
    std::string line(message);
    while (!line.empty() && line.back() == '\n') line.pop_back();
    std::replace(line.begin(), line.end(), '\n', ' ');
    say(on_terminal(2, fmt::fg(colour) | fmt::emphasis::bold), "{}", title);
    say(" {}\n", line);
}

}  // namespace

void print_error(std::string_view message) { print_line("crumple:", fmt::terminal_color::red, message); }

void print_note(std::string_view message) { print_line("crumple: note:", fmt::terminal_color::cyan, message); }
void print_warning(std::string_view message) { print_line("crumple: warning:", fmt::terminal_color::yellow, message); }

fmt::text_style on_terminal(int stream, fmt::text_style style) {
    const char* const no_colour = std::getenv("NO_COLOR");
    const bool plain = (no_colour && *no_colour) || !isatty(stream);
    return plain ? fmt::text_style() : style;
}

std::string readable_bytes(std::int64_t bytes) {
    constexpr std::array units{"bytes", "KiB", "MiB", "GiB", "TiB"};
    auto value = static_cast<double>(bytes);
    std::size_t unit = 0;
    for (; value >= 1024 && unit + 1 < units.size(); ++unit) value /= 1024;
    return fmt::format("{:.{}f} {}", value, unit ? 1 : 0, units[unit]);
}

Progress::Progress(std::size_t steps) : steps_(steps), shown_(isatty(2) && steps > 1) {}

Progress::~Progress() { clear(); }

void Progress::show(std::size_t step, std::string_view text) {
    if (!shown_) return;
    constexpr std::size_t width = 30;
    const std::size_t filled = width * step / steps_;
    say("\r\x1b[K[{:#<{}}{: <{}}] {}/{} {}", "", filled, "", width - filled, step, steps_, text);
}

void Progress::clear() {
    if (!shown_) return;
    say("\r\x1b[K");
}

}  // namespace crumple::cli
