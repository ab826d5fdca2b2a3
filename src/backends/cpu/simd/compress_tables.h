#pragma once

// Shuffles that pack the selected lanes of a vector to the front, by the mask's bits.

#include <array>
#include <cstddef>
#include <cstdint>

namespace crumple::cpu {

/// Shuffle for each mask of `lanes` lanes. The shuffle moves lanes in `pieces` pieces each; for each piece of the
/// packed vector, the table has the index of its source.
template <std::size_t lanes, std::size_t pieces>
struct CompressTable {
    alignas(64) std::uint8_t order[std::size_t{1} << lanes][lanes * pieces];

    constexpr CompressTable() : order{} {
        for (std::size_t mask = 0; mask < (std::size_t{1} << lanes); ++mask) {
            std::size_t packed = 0;
            for (std::size_t lane = 0; lane < lanes; ++lane)
                if (mask >> lane & 1)
                    for (std::size_t piece = 0; piece < pieces; ++piece)
                        order[mask][packed++] = static_cast<std::uint8_t>(pieces * lane + piece);
        }
    }
    constexpr const std::uint8_t* operator[](std::uint64_t mask) const { return order[mask]; }
};

inline constexpr CompressTable<4, 4> compress_shuffles_32;  ///< byte indices, for four lanes of 32 bits
inline constexpr CompressTable<8, 1> compress_orders_32;    ///< lane indices, for eight lanes of 32 bits

}  // namespace crumple::cpu
