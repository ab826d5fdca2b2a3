#pragma once

// Exact sums of float64 numbers, in fixed point that is wide enough for all of them. Integer addition is associative,
// so a sum does not depend on how its terms are grouped or ordered. Host only.

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <optional>

#include "exact/overlap/enclosed.h"
#include "exact/overlap/scaled.h"

namespace crumple {

class FixedSum {
   public:
    void add(double x) {
        const auto bits = std::bit_cast<std::uint64_t>(x);
        const auto exponent = static_cast<int>(bits >> 52 & 2047);
        const std::uint64_t fraction = bits & ((std::uint64_t{1} << 52) - 1);
        const std::uint64_t mantissa = exponent ? fraction | std::uint64_t{1} << 52 : fraction;
        const int place = exponent ? exponent - 1 : 0;  // exponent of the last bit, plus 1074
        const auto digit = static_cast<std::size_t>(place) / digit_bits;
        const int shift = place % digit_bits;
        // A mantissa of 53 bits, shifted by up to 31 bits, fits in three digits.
        const std::uint64_t low = mantissa << shift, high = shift ? mantissa >> (64 - shift) : 0;
        const std::int64_t sign = bits >> 63 ? -1 : 1;
        digits_[digit] += sign * static_cast<std::int64_t>(low & digit_mask);
        digits_[digit + 1] += sign * static_cast<std::int64_t>(low >> digit_bits);
        digits_[digit + 2] += sign * static_cast<std::int64_t>(high);
        begin_ = std::min(begin_, digit);
        end_ = std::max(end_, digit + 3);
        if (++additions_ == most_additions) carry();
    }
    void add(const Enclosed& x) {
        add(x.value.high);
        add(x.value.low);
        error_ = detail::above * (error_ + x.error);
    }
    void add(const FixedSum& other) {
        FixedSum carried = other;
        carried.carry();
        carry();
        for (std::size_t i = carried.begin_; i < carried.end_; ++i) digits_[i] += carried.digits_[i];
        begin_ = std::min(begin_, carried.begin_);
        end_ = std::max(end_, carried.end_);
        ++additions_;
        error_ = detail::above * (error_ + other.error_);
    }
    /// Adds `times` · factor · sum; `times` is positive and below 2^20. Nothing may overflow or underflow.
    void add_product(const FixedSum& sum, double factor, int times = 1);

    double error() const { return error_; }

    /// Returns the float64 nearest to the sum divided by an integer, ties to even, or nothing if that is not certain.
    std::optional<RoundedSum> rounded_quotient(std::int32_t divisor) const;

   private:
    static constexpr int digit_bits = 32;
    static constexpr std::uint64_t digit_mask = 0xffffffff;
    /// Number of digits: from 2^-1074 to beyond 2^1024 times any number of terms.
    static constexpr std::size_t digits = 2110 / digit_bits + 5;
    static constexpr std::int64_t most_additions = std::int64_t{1} << 30;

    /// Normalises all digits but the last used one to 0 .. 2^32 - 1.
    void carry();
    /// Carries, and replaces the sum by its absolute value. Returns true if it was negative.
    bool make_magnitude();
    double nearest_quotient(std::int32_t divisor) const;

    std::array<std::int64_t, digits> digits_{};
    std::size_t begin_ = digits, end_ = 0;  ///< range of digits in use; all others are 0
    std::int64_t additions_ = 0;
    double error_ = 0;  ///< bound on the sum of the errors of all added terms
};

}  // namespace crumple
