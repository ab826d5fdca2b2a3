#pragma once

// Order of keys in CUB's radix sorts: by a range of bits of an unsigned number that is ordered like the keys.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace cuda_on_cpu {

template <std::size_t Bytes>
using UnsignedOf = std::conditional_t<
    Bytes == 1, std::uint8_t,
    std::conditional_t<Bytes == 2, std::uint16_t, std::conditional_t<Bytes == 4, std::uint32_t, std::uint64_t>>>;

/// Returns a number that is ordered like the keys; -0 equals +0.
template <class Key>
std::uint64_t ordered_bits(Key key) {
    static_assert(std::is_arithmetic_v<Key> && sizeof(Key) <= 8);
    using Bits = UnsignedOf<sizeof(Key)>;
    constexpr Bits sign = static_cast<Bits>(Bits{1} << (sizeof(Key) * 8 - 1));
    if constexpr (std::is_floating_point_v<Key>) {
        if (key == Key{0}) key = Key{0};  // -0
        const auto bits = std::bit_cast<Bits>(key);
        return static_cast<Bits>(bits & sign ? ~bits : bits | sign);
    } else if constexpr (std::is_signed_v<Key>) {
        return static_cast<Bits>(static_cast<Bits>(key) ^ sign);
    } else {
        return static_cast<Bits>(key);
    }
}

/// Returns bits [begin, end) of ordered_bits(key).
template <class Key>
std::uint64_t digit(Key key, int begin, int end) {
    const int width = end - begin;
    const std::uint64_t shifted = ordered_bits(key) >> begin;
    return width >= 64 ? shifted : shifted & ((std::uint64_t{1} << width) - 1);
}

}  // namespace cuda_on_cpu
