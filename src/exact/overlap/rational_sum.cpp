#include "exact/overlap/rational_sum.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

namespace crumple {
namespace {

/// Rounds numerator / denominator · 2^exponent, with a positive denominator, to 53 bits, or to fewer so that the last
/// bit is at least 2^least_unit. Returns the mantissa, and the exponent of its last place.
std::pair<std::int64_t, int> round(const mp::cpp_int& numerator, const mp::cpp_int& denominator, int exponent,
                                   int least_unit) {
    if (numerator == 0) return {0, 0};
    constexpr int precision = std::numeric_limits<double>::digits;
    const auto shifted = [](const mp::cpp_int& x, int shift) { return shift > 0 ? mp::cpp_int(x << shift) : x; };
    const mp::cpp_int magnitude = mp::abs(numerator);
    int power = static_cast<int>(msb(magnitude)) - static_cast<int>(msb(denominator));
    if (shifted(magnitude, -power) < shifted(denominator, power)) --power;
    // Now 2^power ≤ quotient < 2^(power + 1).
    const int unit = std::max(power + exponent - precision + 1, least_unit);
    const mp::cpp_int divisor = shifted(denominator, unit - exponent);
    mp::cpp_int places, remainder;
    divide_qr(shifted(magnitude, exponent - unit), divisor, places, remainder);
    const int half = mp::cpp_int(2 * remainder).compare(divisor);
    if (half > 0 || (half == 0 && bit_test(places, 0))) ++places;
    const auto rounded = static_cast<std::int64_t>(places);
    return {numerator < 0 ? -rounded : rounded, unit};
}

RoundedSum round(const mp::cpp_int& numerator, const mp::cpp_int& denominator, int exponent) {
    constexpr int least = std::numeric_limits<double>::min_exponent - std::numeric_limits<double>::digits;  // 2^-1074
    const auto [places, unit] = round(numerator, denominator, exponent, least);
    const auto [mantissa, power] = round(numerator, denominator, exponent, std::numeric_limits<int>::min() / 2);
    return {places == 0 ? 0 : std::ldexp(static_cast<double>(places), unit),
            Scaled(static_cast<double>(mantissa), power)};
}

bool same(const RoundedSum& x, const RoundedSum& y) {
    return x.value == y.value && x.scaled.mantissa == y.scaled.mantissa && x.scaled.exponent == y.scaled.exponent;
}

/// Returns the square root of a positive number, or nothing if the root is irrational.
std::optional<Rational> rational_root(const Rational& square) {
    const mp::cpp_int above = numerator(square), below = denominator(square), root_above = mp::sqrt(above),
                      root_below = mp::sqrt(below);
    if (root_above * root_above != above || root_below * root_below != below) return std::nullopt;
    return Rational(root_above, root_below);
}

/// Returns the quotient, rounded down.
mp::cpp_int floor_quotient(const mp::cpp_int& numerator, const mp::cpp_int& denominator) {
    mp::cpp_int quotient, remainder;
    divide_qr(numerator, denominator, quotient, remainder);
    return remainder < 0 ? mp::cpp_int(quotient - 1) : quotient;
}

}  // namespace

void RationalSum::Part::add(const mp::cpp_int& other, int other_exponent) {
    if (numerator == 0) exponent = other_exponent;
    const int down = exponent - other_exponent;
    if (down > 0) numerator <<= down, exponent = other_exponent;
    numerator += down < 0 ? mp::cpp_int(other << -down) : other;
}

void RationalSum::add(const Rational& term) {
    if (term == 0) return;
    const mp::cpp_int below = denominator(term);
    const auto twos = static_cast<int>(lsb(below));
    numerators_[below >> twos].add(numerator(term), -twos);
}

void RationalSum::add(const Integer& numerator, const Integer& denominator, int exponent) {
    if (numerator == 0) return;
    const auto twos = static_cast<int>(lsb(denominator));
    numerators_[mp::cpp_int(denominator >> twos)].add(mp::cpp_int(numerator), exponent - twos);
}

void RationalSum::add(const RationalSum& other) { add_product(other, 1); }

void RationalSum::add_product(const RationalSum& sum, double factor, int times) {
    const Binary binary(factor);
    if (binary.mantissa == 0) return;
    for (const auto& [below, part] : sum.numerators_)
        numerators_[below].add(part.numerator * binary.mantissa * times, part.exponent + binary.exponent);
}

RoundedSum RationalSum::rounded_quotient(int divisor, Cancellation& cancellation) const {
    constexpr int bits = 400;
    int largest = std::numeric_limits<int>::min();
    std::int64_t terms = 0;
    for (const auto& [below, part] : numerators_) {
        if (part.numerator == 0) continue;
        ++terms;
        largest = std::max(
            largest, static_cast<int>(msb(mp::abs(part.numerator))) + part.exponent - static_cast<int>(msb(below)));
    }
    if (terms == 0) return {};
    const int unit = largest - bits;
    mp::cpp_int low = 0;
    for (const auto& [below, part] : numerators_) {
        cancellation.check();
        const int shift = part.exponent - unit;
        low += shift > 0 ? floor_quotient(part.numerator << shift, below)
                         : floor_quotient(part.numerator, below << -shift);
    }
    const RoundedSum least = round(low, divisor, unit);
    if (same(least, round(low + terms, divisor, unit))) return least;
    const Rational sum = total(cancellation);
    return round(numerator(sum), denominator(sum) * divisor, 0);
}

Rational RationalSum::total(Cancellation& cancellation) const {
    std::vector<Rational> sums;
    sums.reserve(numerators_.size());
    for (const auto& [below, part] : numerators_)
        if (part.exponent < 0)
            sums.emplace_back(part.numerator, below << -part.exponent);
        else
            sums.emplace_back(part.numerator << part.exponent, below);
    // Adds in a balanced tree, so that few additions have large operands.
    while (sums.size() > 1) {
        for (std::size_t i = 0; 2 * i < sums.size(); ++i) {
            cancellation.check();
            sums[i] = 2 * i + 1 < sums.size() ? Rational(sums[2 * i] + sums[2 * i + 1]) : sums[2 * i];
        }
        sums.resize((sums.size() + 1) / 2);
    }
    return sums.empty() ? Rational(0) : sums[0];
}

void RootSum::add(const RootSum& other) {
    for (const auto& [square, sum] : other.of_) of_[square].add(sum);
}

RoundedSum RootSum::rounded_quotient(int divisor, Cancellation& cancellation) const {
    RationalSum rational;
    std::vector<Rational> squares;  // squares of the irrational terms
    for (const auto& [square, sum] : of_) {
        const Rational times = sum.total(cancellation);
        if (times == 0) continue;
        if (const auto root = rational_root(square))
            rational.add(times * *root);
        else
            squares.push_back(times * times * square);
    }
    if (squares.empty()) return rational.rounded_quotient(divisor, cancellation);
    const Rational rest = rational.total(cancellation);
    const auto power = [](const Rational& x) {  // 2^power < 2 x
        return static_cast<int>(msb(numerator(x))) - static_cast<int>(msb(denominator(x)));
    };
    int largest = rest == 0 ? std::numeric_limits<int>::min() : power(rest);
    for (const Rational& square : squares) largest = std::max(largest, power(square) / 2);
    const auto floor_in_units = [](const Rational& x, int unit) {
        return unit < 0 ? floor_quotient(numerator(x) << -unit, denominator(x))
                        : floor_quotient(numerator(x), denominator(x) << unit);
    };
    for (int bits = 128;; bits *= 2) {
        const int unit = largest - bits;
        mp::cpp_int low = floor_in_units(rest, unit);
        for (const Rational& square : squares) {
            cancellation.check();
            low += mp::sqrt(floor_in_units(square, 2 * unit));
        }
        const mp::cpp_int high = low + squares.size() + 1;
        const RoundedSum least = round(low, divisor, unit);
        if (same(least, round(high, divisor, unit))) return least;
    }
}

}  // namespace crumple
