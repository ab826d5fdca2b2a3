#pragma once

// Scanner: words and numbers of a text file, without copies. Lines end with LF, CR LF or CR. Numbers are rounded once,
// directly to the type asked for (std::from_chars), whatever the locale. Every error names the line.

#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>

#include "io/bytes/source.h"

namespace crumple::io {

/// Of a decimal number that std::from_chars calls out of range: whether it is too small rather than too large, which
/// the decimal exponent of its first digit other than zero tells.
inline bool underflows(std::string_view decimal) {
    std::int64_t exponent = 0;
    bool point = false, significant = false;
    std::size_t i = 0;
    for (; i < decimal.size() && decimal[i] != 'e' && decimal[i] != 'E'; ++i) {
        if (decimal[i] == '.') {
            point = true;
        } else if (decimal[i] != '-') {
            significant = significant || decimal[i] != '0';
            if (significant && !point) ++exponent;
            if (!significant && point) --exponent;
        }
    }
    if (i < decimal.size()) {
        const char* digits = decimal.data() + i + 1;
        if (*digits == '+') ++digits;
        const bool negative = *digits == '-';
        std::int64_t written = 0;
        const auto [end, error] = std::from_chars(digits, decimal.data() + decimal.size(), written);
        if (error == std::errc::result_out_of_range) return negative;
        return written <= -exponent;
    }
    return exponent <= 0;
}

/// A number, as from_chars reads it, "nan" and "inf" included; nothing if it is none.
inline std::optional<double> number_of(std::string_view word) {
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (end != word.data() + word.size() || error == std::errc::invalid_argument) return std::nullopt;
    if (error == std::errc::result_out_of_range) value = underflows(word) ? 0 : HUGE_VAL;
    return value;
}

/// The decimal number that text begins with.
template <class Scalar>
struct LeadingNumber {
    Scalar value = 0;           ///< infinite if it overflows
    const char* end = nullptr;  ///< null if there is none; nan and inf are none
};

template <class Scalar>
LeadingNumber<Scalar> leading_number(const char* begin, const char* end) {
    LeadingNumber<Scalar> number;
    const char* const digits = begin + (begin != end && *begin == '-');
    const bool decimal = digits != end && (*digits == '.' || (*digits >= '0' && *digits <= '9'));
    const auto [stop, error] = std::from_chars(begin, end, number.value);
    if (error == std::errc::invalid_argument || !decimal) return {};
    number.end = stop;
    if (error != std::errc::result_out_of_range) return number;
    const std::string_view written(begin, static_cast<std::size_t>(stop - begin));
    number.value = underflows(written) ? Scalar(0) : std::numeric_limits<Scalar>::infinity();
    if (*begin == '-') number.value = -number.value;
    return number;
}

class Scanner {
   public:
    struct Syntax {
        bool lines = false;         ///< an item ends with its line; otherwise a line's end is but a blank
        bool comments = false;      ///< '#' and what follows it in the line is skipped
        bool continuation = false;  ///< a backslash at a line's end is a blank, and so is that end
    };

    Scanner(const Source& source, Syntax syntax, const char* begin)
        : source_(source), syntax_(syntax), p_(begin), end_(source.end()) {}
    Scanner(const Source& source, Syntax syntax) : Scanner(source, syntax, source.text_begin()) {}

    const char* position() const { return p_; }
    std::size_t remaining() const { return static_cast<std::size_t>(end_ - p_); }
    bool at_end() const { return p_ == end_; }

    /// Skips blanks; true if nothing else is left (of the line, if the syntax has lines).
    bool finished() {
        while (p_ != end_) {
            if (is_blank(*p_) || (ends_line(*p_) && !syntax_.lines)) {
                ++p_;
            } else if (const std::size_t length = continuation(p_)) {
                p_ += length;
            } else {
                return ends_line(*p_) || (*p_ == '#' && syntax_.comments);
            }
        }
        return true;
    }

    /// To the first item of the next line that has any; false at the end of the file.
    bool next_line_with_items() {
        while (!at_end() && finished()) skip_line();
        return !at_end();
    }

    /// To the start of the next line. A comment ends with its line even if it ends with a backslash.
    void skip_line() {
        const bool comment = p_ != end_ && *p_ == '#' && syntax_.comments;
        while (p_ != end_ && !ends_line(*p_)) p_ += comment ? 1 : std::max<std::size_t>(1, continuation(p_));
        if (p_ != end_) ++p_;
    }

    /// The next word; `what` is missing if there is none.
    std::string_view word(const char* what = "a word") {
        if (finished()) fail(std::string(what) + " is missing");
        const char* const begin = p_;
        p_ = end_of_word();
        return {begin, static_cast<std::size_t>(p_ - begin)};
    }

    /// The next integer, a word of its own.
    std::int64_t integer(const char* what = "an integer") {
        const std::int64_t value = leading_integer(what);
        end_word(what);
        return value;
    }

    /// After an item: nothing of its word may be left.
    void end_word(const char* what = "an integer") const {
        if (p_ != end_of_word()) fail("in " + std::string(what) + ": " + in_quotes(rest_of_word()) + " is left over");
    }

    /// Skips this character, and blanks before it, if it is next.
    bool skip(char c) {
        const char* p = p_;
        while (p != end_ && is_blank(*p)) ++p;
        if (p == end_ || *p != c) return false;
        p_ = p + 1;
        return true;
    }

    /// Skips so many characters of this word.
    void skip_characters(std::size_t count) { p_ += count; }

    /// The next word's integer, up to the first character that is not a digit.
    std::int64_t leading_integer(const char* what) {
        if (finished()) fail(std::string(what) + " is missing");
        std::int64_t value = 0;
        const auto [end, error] = std::from_chars(skip_plus(), end_, value);
        if (error == std::errc::invalid_argument) fail(in_quotes(rest_of_word()) + " is not " + what);
        if (error == std::errc::result_out_of_range) fail(in_quotes(rest_of_word()) + " is too large for " + what);
        p_ = end;
        return value;
    }

    /// The next number, a word of its own. Neither overflow nor nan nor inf is a number.
    template <class Scalar>
    Scalar real() {
        if (finished()) fail("a number is missing");
        const char* const begin = skip_plus();
        const auto [value, end] = leading_number<Scalar>(begin, end_);
        if (!end || !ends_word(end)) fail(in_quotes(rest_of_word()) + " is not a finite number");
        if (!std::isfinite(value)) {
            const std::string_view written(begin, static_cast<std::size_t>(end - begin));
            fail(in_quotes(written) + (sizeof(Scalar) == 4 ? " overflows float32" : " overflows float64"));
        }
        p_ = end;
        return value;
    }

    /// From here to the next blank.
    std::string_view rest_of_word() const { return {p_, static_cast<std::size_t>(end_of_word() - p_)}; }

    [[noreturn]] void fail(const std::string& what) const { fail(p_, what); }
    [[noreturn]] void fail(const char* place, const std::string& what) const { source_.fail_at_line(place, what); }

   private:
    static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
    static bool ends_line(char c) { return c == '\n' || c == '\r'; }  // CR LF ends an empty line, too

    /// Length of a backslash with the line's end after it, or 0.
    std::size_t continuation(const char* p) const {
        if (*p != '\\' || !syntax_.continuation || end_ - p < 2 || !ends_line(p[1])) return 0;
        return end_ - p >= 3 && p[1] == '\r' && p[2] == '\n' ? 3 : 2;
    }
    bool ends_word(const char* p) const {
        return p == end_ || is_blank(*p) || ends_line(*p) || (*p == '#' && syntax_.comments) || continuation(p) > 0;
    }
    const char* end_of_word() const {
        const char* p = p_;
        while (!ends_word(p)) ++p;
        return p;
    }
    const char* skip_plus() const { return p_ + (*p_ == '+' && end_ - p_ > 1 && p_[1] != '-'); }

    const Source& source_;
    Syntax syntax_;
    const char* p_;
    const char* end_;
};

}  // namespace crumple::io
