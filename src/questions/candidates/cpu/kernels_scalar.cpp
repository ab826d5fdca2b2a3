// Plain C++ for the inner loop of candidates.

#include <algorithm>
#include <bit>

#include "questions/candidates/cpu/kernels.h"

namespace crumple::cpu {
namespace {

std::size_t overlaps(const CandidateRecord* record, const Candidates& candidates, std::int64_t begin, std::int64_t end,
                     const AskedLanes& asked, BoxHit* hit) {
    const CandidateRecord* rows = record + candidates.rows;
    const CandidateRecord* columns = record + candidates.columns;
    const unsigned rows_asked = asked_rows(asked);
    std::size_t count = 0;
    for (std::int64_t k = begin; k < end; ++k) {
        const std::uint16_t i = candidates.row[k], j = candidates.column[k];
        if (j == candidates.dummy) continue;
        const CandidateRecord &a = rows[i], &b = columns[j];
        for (unsigned lanes = a.owned & rows_asked; lanes; lanes &= lanes - 1) {
            const int f = std::countr_zero(lanes);
            float gap[candidate_lanes];
            for (int l = 0; l < candidate_lanes; ++l) {
                gap[l] = std::max(b.low[0][l] - a.high[0][f], a.low[0][f] - b.high[0][l]);
                for (int axis = 1; axis < 3; ++axis)
                    gap[l] =
                        std::max(gap[l], std::max(b.low[axis][l] - a.high[axis][f], a.low[axis][f] - b.high[axis][l]));
            }
            unsigned overlap = 0, unsure = 0;
            for (int l = 0; l < candidate_lanes; ++l) {
                overlap |= unsigned{gap[l] <= 0} << l;
                unsure |= unsigned{gap[l] == 0} << l;
            }
            overlap &= asked[f];
            if (overlap != 0) overlap &= ~incident_lanes(a, f, b);
            hit[count] = {i, j, static_cast<std::uint8_t>(f), static_cast<std::uint8_t>(overlap),
                          static_cast<std::uint8_t>(unsure & overlap)};
            count += overlap != 0;
        }
    }
    return count;
}

}  // namespace

const CandidateKernels scalar_candidates{overlaps};

}  // namespace crumple::cpu
