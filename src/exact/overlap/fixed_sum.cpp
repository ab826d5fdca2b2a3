#include "exact/overlap/fixed_sum.h"

#include <cmath>

namespace crumple {

void FixedSum::carry() {
    additions_ = 0;
    const auto carry_from = [&](std::size_t i) {
        const std::int64_t over = digits_[i] >> digit_bits;
        digits_[i] -= over * (std::int64_t{1} << digit_bits);
        digits_[i + 1] += over;
    };
    for (std::size_t i = begin_; i + 1 < end_; ++i) carry_from(i);
    const auto is_wide = [](std::int64_t digit) { return (digit < 0 ? -digit : digit) >> digit_bits != 0; };
    for (; end_ > begin_ && end_ < digits && is_wide(digits_[end_ - 1]); ++end_) carry_from(end_ - 1);
}

bool FixedSum::make_magnitude() {
    carry();
    const bool negative = end_ > begin_ && digits_[end_ - 1] < 0;
    if (negative) {
        for (std::size_t i = begin_; i < end_; ++i) digits_[i] = -digits_[i];
        carry();
    }
    return negative;
}

void FixedSum::add_product(const FixedSum& sum, double factor, int times) {
    if (factor == 0) return;
    FixedSum magnitude = sum;
    const double signed_factor = magnitude.make_magnitude() ? -factor : factor;
    for (std::size_t i = magnitude.begin_; i < magnitude.end_; ++i) {
        if (magnitude.digits_[i] == 0) continue;
        const int place = digit_bits * static_cast<int>(i) - 1074;
        const TwoTerms product =
            two_product(std::ldexp(static_cast<double>(times * magnitude.digits_[i]), place), signed_factor);
        add(product.high);
        add(product.low);
    }
    error_ = detail::above * (error_ + times * std::abs(factor) * sum.error_);
}

std::optional<RoundedSum> FixedSum::rounded_quotient(std::int32_t divisor) const {
    if (!std::isfinite(error_)) return std::nullopt;
    FixedSum low = *this, high = *this;
    low.add(-error_);
    high.add(error_);
    const double rounded = low.nearest_quotient(divisor);
    if (rounded == high.nearest_quotient(divisor)) return RoundedSum{rounded, Scaled(rounded)};
    return std::nullopt;
}

double FixedSum::nearest_quotient(std::int32_t divisor) const {
    FixedSum magnitude = *this;
    const bool negative = magnitude.make_magnitude();
    // Long division, from the top digit. A nonzero remainder stands for the digits of the quotient beyond the last one.
    const auto by = static_cast<std::uint64_t>(divisor);
    std::uint64_t remainder = 0;
    std::size_t top = digits;
    for (std::size_t i = magnitude.end_; i-- > 0;) {
        if (i < magnitude.begin_ && (remainder == 0 || (top != digits && top - i > 3))) break;
        const std::uint64_t number = remainder << digit_bits | static_cast<std::uint64_t>(magnitude.digits_[i]);
        magnitude.digits_[i] = static_cast<std::int64_t>(number / by);
        remainder = number % by;
        if (top == digits && magnitude.digits_[i] != 0) top = i;
    }
    if (top == digits) return 0;
    // The leading 64 bits of the quotient. The last of them is also set if any nonzero bit follows, so that the
    // conversion below rounds correctly.
    const auto digit = [&](std::size_t back) {
        return back <= top ? static_cast<std::uint64_t>(magnitude.digits_[top - back]) : 0;
    };
    const int leading = std::countl_zero(digit(0)) - digit_bits;  // leading zeros of the top digit
    std::uint64_t head = digit(0) << digit_bits | digit(1), tail = digit(2);
    bool more = remainder != 0;
    for (std::size_t back = 3; back <= top; ++back) more |= digit(back) != 0;
    if (leading > 0) {
        head = head << leading | tail >> (digit_bits - leading);
        tail = tail << leading & digit_mask;
    }
    if (tail != 0 || more) head |= 1;
    const int exponent = digit_bits * (static_cast<int>(top) - 1) - leading - 1074;
    // The conversion rounds 64 bits to 53, once; scaling is exact for normal numbers.
    const double rounded = std::ldexp(static_cast<double>(head), exponent);
    return negative ? -rounded : rounded;
}

}  // namespace crumple
