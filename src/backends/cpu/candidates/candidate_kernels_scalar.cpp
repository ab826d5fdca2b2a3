// Inner loop of candidate queries in plain C++, and the schedule of tests (LaneSteps) that all tables share.

#include <algorithm>

#include "backends/cpu/candidates/candidate_kernels.h"

namespace crumple::cpu {
namespace {

// Returns the largest gap between two boxes on any axis; at most 0 if they overlap.
float gap(const CandidateRecord& a, int lane_a, const CandidateRecord& b, int lane_b) {
    float most = -beyond;
    for (int axis = 0; axis < 3; ++axis) {
        most = std::max(most, b.low[axis][lane_b] - a.high[axis][lane_a]);
        most = std::max(most, a.low[axis][lane_a] - b.high[axis][lane_b]);
    }
    return most;
}

std::size_t find(const CandidateRecord* record, const CandidateChunk& candidates, std::int64_t begin, std::int64_t end,
                 const LaneSteps& rounds, PairEnds& next, UncertainTests* unsure) {
    const CandidateRecord* rows = record + candidates.rows;
    const CandidateRecord* columns = record + candidates.columns;
    std::size_t count = 0;
    for (std::int64_t k = begin; k < end; ++k) {
        const std::uint16_t i = candidates.row[k], j = candidates.column[k];
        if (j == candidates.dummy) continue;
        const CandidateRecord &a = rows[i], &b = columns[j];
        std::uint64_t overlap = 0, equal = 0;
        for (int bit = 0; bit < 8 * rounds.count; ++bit) {
            const LaneSteps::Listed& lanes = rounds.listed[bit];
            if (lanes.row == 7) continue;
            const float between = gap(a, lanes.row, b, lanes.column);
            overlap |= std::uint64_t{between <= 0} << bit;
            equal |= std::uint64_t{between == 0} << bit;
        }
        overlap &= ~rounds.incident[SharedCorners(a, b).bits()];
        list_pairs(overlap & ~equal, rounds, a, b, next);
        unsure[count] = {overlap & equal, i, j};
        count += (overlap & equal) != 0;
    }
    return count;
}

}  // namespace

LaneSteps::LaneSteps(const RequestedKinds& kinds, bool neighbours) {
    has_impact_kinds_only = kinds == RequestedKinds{true, true} && !neighbours;
    for (auto& lanes : row) std::fill_n(lanes, candidate_lanes, std::uint8_t{7});
    for (int column = 0; column < most; ++column) {
        int round = 0;
        for (std::uint8_t lane = 0; lane < most; ++lane)
            if (kinds[static_cast<std::size_t>(kind_of(lane, column))]) row[round++][column] = lane;
        count = std::max(count, round);
    }
    for (int bit = 0; bit < 8 * count; ++bit) {
        const int a = row[bit / 8][bit % 8], b = bit % 8;
        listed[bit] = {static_cast<std::uint8_t>(kind_of(a, b)), static_cast<std::uint8_t>(a),
                       static_cast<std::uint8_t>(b), type_of(b) < type_of(a), type_of(b) == type_of(a)};
        for (unsigned shared = 0; shared < 512 && !neighbours; ++shared)
            if (SharedCorners(shared).incident(a, b)) incident[shared] |= std::uint64_t{1} << bit;
    }
}

const CandidateKernels scalar_candidates{find};

}  // namespace crumple::cpu
