#pragma once

// Byte shuffles that pack the selected lanes of 128 bits to the front, by the mask's bits.

#include <array>
#include <cstddef>
#include <cstdint>

namespace crumple::cpu {

template <std::size_t lane_bytes>
struct CompressShuffles {
    static constexpr std::size_t lanes = 16 / lane_bytes;
    alignas(64) std::uint8_t order[std::size_t{1} << lanes][16];

    constexpr CompressShuffles() : order{} {
        for (std::size_t mask = 0; mask < (std::size_t{1} << lanes); ++mask) {
            std::size_t packed = 0;
            for (std::size_t lane = 0; lane < lanes; ++lane)
                if (mask >> lane & 1)
                    for (std::size_t byte = 0; byte < lane_bytes; ++byte)
                        order[mask][packed++] = static_cast<std::uint8_t>(lane_bytes * lane + byte);
            for (; packed < 16; ++packed) order[mask][packed] = 0;
        }
    }
    constexpr const std::uint8_t* operator[](std::uint64_t mask) const { return order[mask]; }
};

inline constexpr CompressShuffles<2> compress_shuffles_16;
inline constexpr CompressShuffles<4> compress_shuffles_32;

}  // namespace crumple::cpu
