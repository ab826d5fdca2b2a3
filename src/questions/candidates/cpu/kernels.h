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

/// What is held against what, in rounds: in each every lane of a column meets one lane of a row, or lane 7, which
/// overlaps nothing. Together they are all that is asked for. Bit 8 j + l is lane l in round j.
struct Rounds {
    static constexpr int most = 7;
    int count = 0;
    std::uint8_t row[most][candidate_lanes];

    /// `asked`: for each lane of a row which of the column's.
    explicit Rounds(const std::uint8_t (&asked)[candidate_lanes] = {});
};

/// What of a row and a column overlaps.
struct BoxHit {
    std::uint64_t overlaps;     ///< boxes overlap, or
    std::uint64_t unsure;       ///< perhaps do, for some keys are equal
    std::uint16_t row, column;  ///< as in Candidates
};

struct CandidateKernels {
    /// Lists candidates of [begin, end) of which something overlaps that is not incident; returns how many. `record`:
    /// by physical row. Writes up to one more.
    std::size_t (*overlaps)(const CandidateRecord* record, const Candidates& candidates, std::int64_t begin,
                            std::int64_t end, const Rounds& rounds, BoxHit* hit);
};

/// The table for an instruction set; throws backend_unavailable if the build or the machine lacks it.
const CandidateKernels& candidate_kernels(Simd simd);

/// All tables that build and machine have, the plain one first: for tests.
std::vector<const CandidateKernels*> all_candidate_kernels();

extern const CandidateKernels scalar_candidates;

/// What is left without those that have a vertex in common.
std::uint64_t without_incident(std::uint64_t overlaps, const Rounds& rounds, const CandidateRecord& a,
                               const CandidateRecord& b);

}  // namespace crumple::cpu
