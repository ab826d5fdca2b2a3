#pragma once

// Tables that turn the selected columns of a step of the sweep into a list, for instruction sets without a compress
// instruction.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace crumple::cpu {

/// Tables for selections of columns. A selection has one bit per column. The bits of 32 columns are in the order 0 to
/// 7, 16 to 23, 8 to 15, 24 to 31, because AVX2 packs two vectors half by half.
template <std::size_t columns>
struct ColumnTables {
    static constexpr std::size_t eights = columns / 8;

    std::array<std::uint32_t, columns + 1> first{};  ///< selects the first n columns
    /// Numbers of the selected columns, packed to the front; indexed by group of eight columns, and by the group's
    /// bits.
    alignas(64) std::uint16_t numbers[eights][256][8]{};

    /// Returns the bit at which a group of eight columns starts.
    static constexpr int position(std::size_t eight) {
        return 8 * static_cast<int>(columns == 32 && (eight == 1 || eight == 2) ? 3 - eight : eight);
    }

    constexpr ColumnTables() {
        for (std::size_t i = 0; i < columns; ++i)
            first[i + 1] = first[i] | std::uint32_t{1} << (position(i / 8) + static_cast<int>(i % 8));
        for (std::size_t k = 0; k < eights; ++k)
            for (std::size_t bits = 0; bits < 256; ++bits) {
                std::size_t listed = 0;
                for (std::size_t i = 0; i < 8; ++i)
                    if (bits >> i & 1) numbers[k][bits][listed++] = static_cast<std::uint16_t>(8 * k + i);
            }
    }

    /// Returns the bits of a group of eight columns as an offset in `numbers`, 16 bytes per entry: one rotation and one
    /// mask.
    static constexpr std::uint32_t offset(std::uint32_t selection, std::size_t eight) {
        return std::rotr(selection, position(eight) - 4) & 0xff0;
    }
    const std::uint16_t* numbers_at(std::size_t eight, std::uint32_t offset) const {
        return reinterpret_cast<const std::uint16_t*>(reinterpret_cast<const std::byte*>(numbers[eight]) + offset);
    }
};

template <std::size_t columns>
inline constexpr ColumnTables<columns> column_tables;

}  // namespace crumple::cpu
