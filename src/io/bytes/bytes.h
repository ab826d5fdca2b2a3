#pragma once

// Conversion of numbers between the byte order of a file and that of the machine.

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace crumple::io {

/// Returns the value at `p`, which need not be aligned.
template <class T>
T load(const char* p, std::endian order) {
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), p, sizeof(T));
    if (order != std::endian::native) std::reverse(bytes.begin(), bytes.end());
    return std::bit_cast<T>(bytes);
}

template <class T>
std::array<char, sizeof(T)> little_endian(T value) {
    auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
    if constexpr (std::endian::native == std::endian::big) std::reverse(bytes.begin(), bytes.end());
    return bytes;
}

}  // namespace crumple::io
