#pragma once

// Results of the filters of `narrow` for a chunk's candidates, and data that the filters pass to each other on the cpu.

#include <array>
#include <cstdint>

#include "backends/cpu/stages/layout.h"
#include "filters/intersection/edge_test.h"

namespace crumple::cpu {

/// Sides on which the corners of candidates lie: seven nibbles per pair, each with its three low bits for the corners
/// and an undefined fourth bit. How they are stored depends on the instruction set (plane_signs-inl.h).
///     above_a, below_a   column's corners relative to the row's plane, if certain
///     above_b, below_b   row's corners relative to the column's plane, if certain
///     same[k]            column's corners that equal the row's corner k
struct PlaneSigns {
    Array<std::uint8_t> bytes;
    explicit PlaneSigns(MemoryMeter* m) : bytes(m) {}
    void resize(std::int64_t candidates) {
        bytes.resize_discard(static_cast<std::size_t>(4 * candidates + 7 * padding));
    }
};

/// Results of the filters of `narrow`, and data that they pass to each other. Pairs are packed as column << 16 | row.
struct Verdicts {
    Array<std::uint32_t> hit;        ///< pairs that certainly collide
    Array<std::uint32_t> undecided;  ///< pairs left to the exact decision
    std::int64_t edge_tests = 0;     ///< number of pairs that the plane filter does not drop
    std::int64_t double_tests = 0;   ///< number of pairs unresolved by the float32 filters
    // Between the SIMD filters:
    PlaneSigns signs;
    Array<std::uint8_t> code;                      ///< code of each candidate, by `classify`
    Array<std::uint32_t> survivor, survivor_code;  ///< candidates that the plane filter does not drop; their codes
    Array<std::uint32_t> edges, edge_signs;  ///< pairs for edge_test; for each, below_a | below_b << 3 of PlaneSigns
    Array<std::uint32_t> flat, flat_shared;  ///< pairs for flat_test; for each, bits of the shared corners: shared_b |
                                             ///< shared_a << 3 (PairSigns)
    explicit Verdicts(MemoryMeter* m)
        : hit(m),
          undecided(m),
          signs(m),
          code(m),
          survivor(m),
          survivor_code(m),
          edges(m),
          edge_signs(m),
          flat(m),
          flat_shared(m) {}
    void reserve(std::int64_t candidates) {
        const auto n = static_cast<std::size_t>(candidates + 2 * padding);
        signs.resize(candidates);
        code.reserve(n);
        for (auto* list : {&hit, &undecided, &survivor, &survivor_code, &edges, &edge_signs, &flat, &flat_shared})
            list->reserve(n);
    }
};

/// Corner orders for the edge test, indexed by below_a | below_b << 3.
inline constexpr std::array<std::int32_t, 64> edge_orders = [] {
    std::array<std::int32_t, 64> orders{};
    for (int bits = 0; bits < 64; ++bits) orders[static_cast<std::size_t>(bits)] = edge_order(bits & 7, bits >> 3);
    return orders;
}();

}  // namespace crumple::cpu
