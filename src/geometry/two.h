#pragma once

// Two float64 numbers at a time, by the vector extension of GCC and clang: every machine that the library is built for
// has registers of 16 bytes, so no instruction set has to be chosen. The same operations and roundings as for one.

#include <cstdint>
#include <cstring>

namespace crumple {

using Two = double __attribute__((vector_size(16)));
/// What comparing makes of two numbers: all bits, or none.
using TwoMasks = decltype(Two{} < Two{});

inline Two load_two(const double* from) {
    Two value;
    std::memcpy(&value, from, sizeof value);
    return value;
}
inline void store_two(Two value, double* to) { std::memcpy(to, &value, sizeof value); }

}  // namespace crumple
