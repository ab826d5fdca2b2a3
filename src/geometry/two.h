#pragma once

// Lanes of two float64 numbers, by the vector extension of GCC and clang. Every machine that the library is built for
// has 16-byte registers, so no instruction set has to be chosen. Operations and roundings are those of single numbers.

#include <cstdint>
#include <cstring>

namespace crumple {

using Two = double __attribute__((vector_size(16)));
/// Result of a comparison: for each lane all bits set, or none.
using TwoMasks = decltype(Two{} < Two{});

inline Two load_two(const double* from) {
    Two value;
    std::memcpy(&value, from, sizeof value);
    return value;
}
inline void store_two(Two value, double* to) { std::memcpy(to, &value, sizeof value); }

}  // namespace crumple
