#pragma once

// Exact sums of float64 numbers: an expansion is the sum of its terms, which increase in magnitude, do not overlap and
// are nonzero. Its sign is that of the last term. Compiled for host and device; nothing is allocated, because the type
// bounds the number of terms.
//
// Error-free transformations after Knuth and Dekker; sums and products after J. R. Shewchuk, "Adaptive Precision
// Floating-Point Arithmetic and Fast Robust Geometric Predicates" (1997), theorems 13 and 19. They need
// round-to-nearest-even, no flush-to-zero, and no product or rounding error that over- or underflows: predicates.h
// states the coordinates that are safe.

#include "geometry/vec.h"

namespace crumple {

/// Unevaluated sum high + low.
struct TwoTerms {
    double high, low;
};

/// Returns a + b, exactly.
CRUMPLE_HD inline TwoTerms two_sum(double a, double b) {
    const double sum = a + b;
    const double b_part = sum - a, a_part = sum - b_part;
    return {sum, (a - a_part) + (b - b_part)};
}

/// Returns a + b, exactly, if a = 0 or |a| ≥ |b|.
CRUMPLE_HD inline TwoTerms fast_two_sum(double a, double b) {
    const double sum = a + b;
    return {sum, b - (sum - a)};
}

/// Returns a · b, exactly: by a fused multiply-add if the processor has one. If it has none, the compiler cannot
/// contract Dekker's splitting, which contraction would break.
CRUMPLE_HD inline TwoTerms two_product(double a, double b) {
    const double product = a * b;
#if defined(__FMA__) || defined(__aarch64__) || defined(__CUDA_ARCH__)
    return {product, std::fma(a, b, -product)};
#else
    constexpr double splitter = 0x1p27 + 1;
    const double scaled_a = splitter * a, scaled_b = splitter * b;
    const double a_high = scaled_a - (scaled_a - a), b_high = scaled_b - (scaled_b - b);
    const double a_low = a - a_high, b_low = b - b_high;
    return {product, a_low * b_low - (((product - a_high * b_high) - a_low * b_high) - a_high * b_low)};
#endif
}

template <int Capacity>
struct Expansion {
    static_assert(Capacity >= 1);
    int size = 0;
    double term[Capacity];

    CRUMPLE_HD Expansion() {}
    // Copies only the terms in use. The implicit copy constructor copies the whole array, and if it is inlined, nvcc
    // 13.0 treats the size of the copy as 0 (docs/nvcc_13_0.md).
    CRUMPLE_HD Expansion(const Expansion& other) : size(other.size) {
        for (int i = 0; i < size; ++i) term[i] = other.term[i];
    }
    // NOLINTNEXTLINE(bugprone-unhandled-self-assignment): copying a term onto itself changes nothing
    CRUMPLE_HD Expansion& operator=(const Expansion& other) {
        size = other.size;
        for (int i = 0; i < size; ++i) term[i] = other.term[i];
        return *this;
    }
    CRUMPLE_HD explicit Expansion(TwoTerms value) {
        append(value.low);
        append(value.high);
    }
    CRUMPLE_HD void append(double value) {
        if (value != 0) term[size++] = value;
    }
    CRUMPLE_HD int sign() const { return size == 0 ? 0 : term[size - 1] > 0 ? 1 : -1; }

    CRUMPLE_HD Expansion operator-() const {
        Expansion result;
        for (int i = 0; i < size; ++i) result.append(-term[i]);
        return result;
    }
};

/// Returns a − b, exactly.
CRUMPLE_HD inline Expansion<2> exact_difference(double a, double b) { return Expansion<2>(two_sum(a, -b)); }

/// Merges the terms by magnitude and adds them from the smallest on (Shewchuk's fast expansion sum).
template <int M, int N>
CRUMPLE_HD Expansion<M + N> operator+(const Expansion<M>& e, const Expansion<N>& f) {
    Expansion<M + N> result;
    int i = 0, j = 0;
    const auto next = [&] {
        if (j == f.size || (i < e.size && std::abs(e.term[i]) < std::abs(f.term[j]))) return e.term[i++];
        return f.term[j++];
    };
    if (e.size + f.size == 0) return result;
    double sum = next();
    while (i < e.size || j < f.size) {
        const TwoTerms s = two_sum(sum, next());
        result.append(s.low);
        sum = s.high;
    }
    result.append(sum);
    return result;
}

template <int M, int N>
CRUMPLE_HD Expansion<M + N> operator-(const Expansion<M>& e, const Expansion<N>& f) {
    return e + -f;
}

/// Returns e · factor, exactly (Shewchuk's scale expansion).
template <int N>
CRUMPLE_HD Expansion<2 * N> operator*(const Expansion<N>& e, double factor) {
    Expansion<2 * N> result;
    if (e.size == 0) return result;
    TwoTerms product = two_product(e.term[0], factor);
    result.append(product.low);
    double sum = product.high;
    for (int i = 1; i < e.size; ++i) {
        product = two_product(e.term[i], factor);
        const TwoTerms low = two_sum(sum, product.low);
        result.append(low.low);
        const TwoTerms high = fast_two_sum(product.high, low.high);
        result.append(high.low);
        sum = high.high;
    }
    result.append(sum);
    return result;
}

template <int M, int N>
CRUMPLE_HD Expansion<2 * M * N> operator*(const Expansion<M>& e, const Expansion<N>& f) {
    Expansion<2 * M * N> result;
    if (f.size == 0) return result;
    const auto assign = [&](const auto& terms) {
        result.size = 0;
        for (int i = 0; i < terms.size; ++i) result.append(terms.term[i]);
    };
    assign(e * f.term[0]);
    for (int j = 1; j < f.size; ++j) assign(result + e * f.term[j]);
    return result;
}

/// Returns e · f for f of two terms, such as a difference: without a loop, and with less scratch memory.
template <int M>
CRUMPLE_HD Expansion<4 * M> operator*(const Expansion<M>& e, const Expansion<2>& f) {
    if (f.size == 0) return {};
    return e * f.term[0] + (f.size == 1 ? Expansion<2 * M>() : e * f.term[1]);
}

}  // namespace crumple
