#include "cli/terminal.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <streambuf>

#include <fmt/format.h>

#include "crumple/error.h"

namespace crumple::cli {

namespace {

/// Writes to standard output and remembers why it failed: std::cout leaves that to errno, which others overwrite.
class StandardOutput : public std::streambuf {
   public:
    StandardOutput() { setp(buffer_.data(), buffer_.data() + buffer_.size()); }
    int reason() const { return reason_; }

   private:
    int sync() override {
        const char* from = pbase();
        while (from != pptr() && !reason_) {
            const ssize_t written = ::write(STDOUT_FILENO, from, static_cast<std::size_t>(pptr() - from));
            if (written >= 0) {
                from += written;
            } else if (errno != EINTR) {
                reason_ = errno;
            }
        }
        setp(buffer_.data(), buffer_.data() + buffer_.size());
        return reason_ ? -1 : 0;
    }
    int_type overflow(int_type c) override {
        if (sync() != 0) return traits_type::eof();
        if (!traits_type::eq_int_type(c, traits_type::eof())) sputc(traits_type::to_char_type(c));
        return traits_type::not_eof(c);
    }

    std::array<char, 1 << 16> buffer_;
    int reason_ = 0;
};

}  // namespace

void to_standard_output(const std::function<void(std::ostream&)>& write) {
    StandardOutput buffer;
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
    std::fwrite(text.data(), 1, text.size(), stderr);
    std::fflush(stderr);
}

void print_error(std::string_view message) {
    std::string line(message);
    while (!line.empty() && line.back() == '\n') line.pop_back();
    std::replace(line.begin(), line.end(), '\n', ' ');
    say(on_terminal(2, fmt::fg(fmt::terminal_color::red) | fmt::emphasis::bold), "crumple:");
    say(" {}\n", line);
}

fmt::text_style on_terminal(int stream, fmt::text_style style) {
    const char* const no_colour = std::getenv("NO_COLOR");
    const bool plain = (no_colour && *no_colour) || !isatty(stream);
    return plain ? fmt::text_style() : style;
}

std::string grouped(std::int64_t number) {
    const std::string digits = std::to_string(number);
    std::string result;
    for (std::size_t i = 0; i < digits.size(); ++i) {
        if (i > 0 && (digits.size() - i) % 3 == 0) result += ',';
        result += digits[i];
    }
    return result;
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
