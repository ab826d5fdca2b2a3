#pragma once

// The inner loop of candidates on the cpu, as tables beside those of the stages (engine/cpu/kernels.h): plain C++, and
// one for each SIMD instruction set (lanes.cpp). All tables list the same.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "crumple/options.h"
#include "engine/cpu/layout.h"
#include "questions/candidates/record.h"

namespace crumple::cpu {

/// What one feature of a row overlaps of a column's.
struct BoxHit {
    std::uint16_t row, column;  ///< as in Candidates
    std::uint8_t lane;          ///< of the row's feature
    std::uint8_t overlaps;      ///< a bit for each lane of the column: the boxes overlap, or
    std::uint8_t unsure;        ///< perhaps do, for some keys are equal
    std::uint8_t unused = 0;
};

/// For each lane of a row which of the column's lanes are asked for.
using AskedLanes = std::uint8_t[candidate_lanes];

struct CandidateKernels {
    /// Lists what candidates [begin, end) overlap of what is asked for, less what is incident; returns how many hits.
    /// `record`: by physical row. Writes up to seven a candidate, and one more.
    std::size_t (*overlaps)(const CandidateRecord* record, const Candidates& candidates, std::int64_t begin,
                            std::int64_t end, const AskedLanes& asked, BoxHit* hit);
};

/// The table for an instruction set; throws backend_unavailable if the build or the machine lacks it.
const CandidateKernels& candidate_kernels(Simd simd);

/// All tables that build and machine have, the plain one first: for tests.
std::vector<const CandidateKernels*> all_candidate_kernels();

extern const CandidateKernels scalar_candidates;

/// The lanes of a row that are asked for against anything.
inline unsigned asked_rows(const AskedLanes& asked) {
    unsigned lanes = 0;
    for (int k = 0; k < candidate_lanes; ++k) lanes |= unsigned{asked[k] != 0} << k;
    return lanes;
}

}  // namespace crumple::cpu
