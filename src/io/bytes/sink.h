#pragma once

// Buffered output of text and of little-endian numbers. Decimal numbers are the shortest that read back as the same
// value.

#include <array>
#include <charconv>
#include <ostream>
#include <string_view>
#include <type_traits>

#include "io/bytes/bytes.h"

namespace crumple::io {

class Sink {
   public:
    explicit Sink(std::ostream& out) : out_(out) {}
    Sink(const Sink&) = delete;
    Sink& operator=(const Sink&) = delete;
    ~Sink() {
        try {
            reserve(buffer_.size());
        } catch (...) {
            // A stream that throws has also set its error state, which the owner of the stream checks.
        }
    }

    Sink& operator<<(char c) {
        reserve(1);
        buffer_[used_++] = c;
        return *this;
    }
    Sink& operator<<(std::string_view text) {
        bytes(text.data(), text.size());
        return *this;
    }
    Sink& operator<<(const char* text) { return *this << std::string_view(text); }

    template <class Number>
    requires std::is_arithmetic_v<Number> Sink& operator<<(Number value) {
        reserve(longest_number);
        char* const begin = buffer_.data() + used_;
        used_ += static_cast<std::size_t>(std::to_chars(begin, begin + longest_number, value).ptr - begin);
        return *this;
    }

    template <class... Number>
    void little(Number... values) {
        (binary(little_endian(values)), ...);
    }

    void bytes(const char* data, std::size_t size) {
        reserve(size);
        if (size > buffer_.size()) {
            out_.write(data, static_cast<std::streamsize>(size));
        } else {
            std::copy_n(data, size, buffer_.data() + used_);
            used_ += size;
        }
    }

   private:
    static constexpr std::size_t longest_number = 32;

    template <std::size_t size>
    void binary(const std::array<char, size>& value) {
        bytes(value.data(), size);
    }
    void reserve(std::size_t size) {
        if (used_ + size <= buffer_.size()) return;
        out_.write(buffer_.data(), static_cast<std::streamsize>(used_));
        used_ = 0;
    }

    std::ostream& out_;
    std::array<char, 1 << 16> buffer_;
    std::size_t used_ = 0;
};

}  // namespace crumple::io
