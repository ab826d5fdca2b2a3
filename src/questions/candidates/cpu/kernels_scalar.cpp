// Plain C++ for the inner loop of candidates, and what all tables share.

#include <algorithm>
#include <bit>

#include "questions/candidates/cpu/kernels.h"

namespace crumple::cpu {
namespace {

// The largest gap on any axis.
float gap(const CandidateRecord& a, int lane_a, const CandidateRecord& b, int lane_b) {
    float most = -beyond;
    for (int axis = 0; axis < 3; ++axis) {
        most = std::max(most, b.low[axis][lane_b] - a.high[axis][lane_a]);
        most = std::max(most, a.low[axis][lane_a] - b.high[axis][lane_b]);
    }
    return most;
}

std::size_t overlaps(const CandidateRecord* record, const Candidates& candidates, std::int64_t begin, std::int64_t end,
                     const Rounds& rounds, BoxHit* hit) {
    const CandidateRecord* rows = record + candidates.rows;
    const CandidateRecord* columns = record + candidates.columns;
    std::size_t count = 0;
    for (std::int64_t k = begin; k < end; ++k) {
        const std::uint16_t i = candidates.row[k], j = candidates.column[k];
        if (j == candidates.dummy) continue;
        const CandidateRecord &a = rows[i], &b = columns[j];
        std::uint64_t overlap = 0, unsure = 0;
        for (int bit = 0; bit < 8 * rounds.count; ++bit) {
            const int row = rounds.row[bit / 8][bit % 8];
            if (row == 7) continue;
            const float between = gap(a, row, b, bit % 8);
            overlap |= std::uint64_t{between <= 0} << bit;
            unsure |= std::uint64_t{between == 0} << bit;
        }
        overlap = without_incident(overlap, rounds, a, b);
        hit[count] = {overlap, unsure & overlap, i, j};
        count += overlap != 0;
    }
    return count;
}

}  // namespace

Rounds::Rounds(const std::uint8_t (&asked)[candidate_lanes]) {
    for (auto& lanes : row) std::fill_n(lanes, candidate_lanes, std::uint8_t{7});
    for (int column = 0; column < candidate_lanes; ++column) {
        int round = 0;
        for (std::uint8_t lane = 0; lane < most; ++lane)
            if (asked[lane] >> column & 1) row[round++][column] = lane;
        count = std::max(count, round);
    }
}

std::uint64_t without_incident(std::uint64_t overlaps, const Rounds& rounds, const CandidateRecord& a,
                               const CandidateRecord& b) {
    const SharedCorners shared(a, b);
    if ((shared.of[0] | shared.of[1] | shared.of[2]) == 0) return overlaps;
    for (std::uint64_t bits = overlaps; bits; bits &= bits - 1) {
        const int bit = std::countr_zero(bits);
        if (shared.incident(rounds.row[bit / 8][bit % 8], bit % 8)) overlaps &= ~(std::uint64_t{1} << bit);
    }
    return overlaps;
}

const CandidateKernels scalar_candidates{overlaps};

}  // namespace crumple::cpu
