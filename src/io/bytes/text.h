#pragma once

// Scanner for words and numbers of a text file, without copies. Lines end with LF, CR LF or CR. Numbers are rounded
// once, directly to the requested type (std::from_chars), regardless of the locale. Every error names the line.

#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>

#include "io/bytes/source.h"

namespace crumple::io {

/// True if a decimal number that std::from_chars reports as out of range is too small, false if it is too large. The
/// decimal exponent of its first nonzero digit decides.
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

/// Parses a whole word as a number, as from_chars does, "nan" and "inf" included; returns nothing if it is not a
/// number.
inline std::optional<double> number_of(std::string_view word) {
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (end != word.data() + word.size() || error == std::errc::invalid_argument) return std::nullopt;
    if (error == std::errc::result_out_of_range)
        value = std::copysign(underflows(word) ? 0 : HUGE_VAL, word.starts_with('-') ? -1 : 1);
    return value;
}

/// Decimal number at the start of a text.
template <class Scalar>
struct LeadingNumber {
    Scalar value = 0;           ///< infinite if the number overflows, 0 if it underflows
    const char* end = nullptr;  ///< end of the number; null if there is none: nan and inf do not count
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
        bool lines = false;         ///< a line end stops finished(), word() and so on; otherwise it counts as a blank
        bool comments = false;      ///< '#' and the rest of its line are skipped
        bool continuation = false;  ///< a backslash and the line end after it count as a blank
    };

    Scanner(const Source& source, Syntax syntax, const char* begin)
        : source_(source), syntax_(syntax), p_(begin), end_(source.end()) {}
    Scanner(const Source& source, Syntax syntax) : Scanner(source, syntax, source.text_begin()) {}

    const char* position() const { return p_; }
    std::size_t remaining() const { return static_cast<std::size_t>(end_ - p_); }
    bool at_end() const { return p_ == end_; }

    /// Skips blanks. Returns true if no word is left in the line (Syntax::lines) or, without lines, in the file.
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

    /// Moves to the next word, in this line or a later one; returns false at the end of the file.
    bool next_line_with_items() {
        while (!at_end() && finished()) skip_line();
        return !at_end();
    }

    /// Moves to the start of the next line. A comment ends with its line even if it ends with a backslash.
    void skip_line() {
        const bool comment = p_ != end_ && *p_ == '#' && syntax_.comments;
        while (p_ != end_ && !ends_line(*p_)) p_ += comment ? 1 : std::max<std::size_t>(1, continuation(p_));
        if (p_ != end_) ++p_;
    }

    /// Returns the next word. If there is none, throws Error "`what` is missing".
    std::string_view word(const char* what = "a word") {
        if (finished()) fail(std::string(what) + " is missing");
        const char* const begin = p_;
        p_ = end_of_word();
        return {begin, static_cast<std::size_t>(p_ - begin)};
    }

    /// Returns the next word as an integer.
    std::int64_t integer(const char* what = "an integer") {
        const std::int64_t value = leading_integer(what);
        end_word(what);
        return value;
    }

    /// Throws Error unless the position is at the end of a word: that is, unless the whole word has been read as
    /// `what`.
    void end_word(const char* what = "an integer") const {
        if (p_ != end_of_word()) fail("unexpected " + in_quotes(rest_of_word()) + " in " + what);
    }

    /// If `c` is the next character after any blanks, skips both and returns true; else changes nothing.
    bool skip(char c) {
        const char* p = p_;
        while (p != end_ && is_blank(*p)) ++p;
        if (p == end_ || *p != c) return false;
        p_ = p + 1;
        return true;
    }

    /// Skips this many characters of the current word.
    void skip_characters(std::size_t count) { p_ += count; }

    /// Returns the integer at the start of the next word, and stops at the first character that is not a digit.
    std::int64_t leading_integer(const char* what) {
        if (finished()) fail(std::string(what) + " is missing");
        std::int64_t value = 0;
        const auto [end, error] = std::from_chars(skip_plus(), end_, value);
        if (error == std::errc::invalid_argument) fail(in_quotes(rest_of_word()) + " is not " + what);
        if (error == std::errc::result_out_of_range) fail(in_quotes(rest_of_word()) + " is too large for " + what);
        p_ = end;
        return value;
    }

    /// Returns the next word as a finite number. Overflow, nan and inf are errors.
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

    /// Returns the text from the position to the end of the word.
    std::string_view rest_of_word() const { return {p_, static_cast<std::size_t>(end_of_word() - p_)}; }

    [[noreturn]] void fail(const std::string& what) const { fail(p_, what); }
    [[noreturn]] void fail(const char* place, const std::string& what) const { source_.fail_at_line(place, what); }

   private:
    static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
    static bool ends_line(char c) { return c == '\n' || c == '\r'; }  // CR LF is two line ends

    /// Returns the length of a backslash and the line end after it, or 0.
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
