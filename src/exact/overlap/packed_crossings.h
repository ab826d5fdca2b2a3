#pragma once

// Crossings of two faces under both shifts (segment.h), packed in 64 bits. Compiled for host and device.
//
//   bits 0 to 16, 17 to 33   crossing under the forward and the backward shift:
//                            2 bits for each of the six jumps, plus 1; 1 bit: a segment;
//                            2 bits for the vertex of each end, plus 1
//   bits 34 to 36            tied, coplanar, uncertain

#include <cstdint>

#include "exact/overlap/segment.h"

namespace crumple {

class PackedCrossings {
   public:
    CRUMPLE_HD static PackedCrossings pack(const DecidedCrossings& both) {
        PackedCrossings packed;
        packed.bits_ = bits_of(both.forward) | bits_of(both.backward) << shift_bits |
                       std::uint64_t{both.tied} << tied_bit | std::uint64_t{both.coplanar} << coplanar_bit;
        return packed;
    }
    CRUMPLE_HD DecidedCrossings unpack() const {
        DecidedCrossings both;
        both.forward = crossing_of(bits_);
        both.backward = crossing_of(bits_ >> shift_bits);
        both.tied = (bits_ >> tied_bit & 1) != 0;
        both.coplanar = (bits_ >> coplanar_bit & 1) != 0;
        return both;
    }

    friend CRUMPLE_HD bool operator==(const PackedCrossings&, const PackedCrossings&) = default;

    /// True if the terms of the pair's segments are missing in sums, because they are too uncertain.
    CRUMPLE_HD bool uncertain() const { return (bits_ >> uncertain_bit & 1) != 0; }
    CRUMPLE_HD void set_uncertain() { bits_ |= std::uint64_t{1} << uncertain_bit; }

   private:
    static constexpr int segment_bit = 12, start_bit = 13, end_bit = 15, shift_bits = 17, tied_bit = 34,
                         coplanar_bit = 35, uncertain_bit = 36;

    CRUMPLE_HD static std::uint64_t bits_of(const DecidedCrossing& crossing) {
        std::uint64_t bits = 0;
        for (std::size_t i = 0; i < 3; ++i)
            bits |= static_cast<std::uint64_t>(crossing.jumps.a[i] + 1) << 2 * i |
                    static_cast<std::uint64_t>(crossing.jumps.b[i] + 1) << (6 + 2 * i);
        if (!crossing.jumps.segment) return bits;
        const auto vertex = [](const SegmentEnd& end) { return static_cast<std::uint64_t>(end.vertex + 1); };
        return bits | std::uint64_t{1} << segment_bit | vertex(crossing.segment.start) << start_bit |
               vertex(crossing.segment.end) << end_bit;
    }
    CRUMPLE_HD static DecidedCrossing crossing_of(std::uint64_t bits) {
        const auto two = [&](std::size_t at) { return static_cast<int>(bits >> at & 3) - 1; };
        DecidedCrossing crossing;
        for (std::size_t i = 0; i < 3; ++i) {
            crossing.jumps.a[i] = two(2 * i);
            crossing.jumps.b[i] = two(6 + 2 * i);
        }
        crossing.jumps.segment = (bits >> segment_bit & 1) != 0;
        if (!crossing.jumps.segment) return crossing;
        crossing.segment = segment_of(crossing.jumps, [](std::size_t, std::size_t) { return -1; });
        crossing.segment.start.vertex = static_cast<std::int8_t>(two(start_bit));
        crossing.segment.end.vertex = static_cast<std::int8_t>(two(end_bit));
        return crossing;
    }

    std::uint64_t bits_ = 0;
};

}  // namespace crumple
