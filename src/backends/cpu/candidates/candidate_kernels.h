#pragma once

// The inner loop of candidates on the cpu, as tables beside those of the stages (backends/cpu/stages/kernels.h): plain
// C++, and one for each SIMD instruction set (candidate_lanes.cpp). All tables list the same.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "backends/cpu/stages/layout.h"
#include "crumple/candidates.h"
#include "crumple/options.h"
#include "filters/candidates/candidate_record.h"
#include "queries/feature_request.h"

namespace crumple::cpu {

/// Where the next pair of each kind is written.
using PairEnds = std::array<Pair*, candidate_kinds>;

/// What is held against what, in rounds: in each every lane of a column meets one lane of a row, or lane 7, which
/// overlaps nothing. Together they are all that is asked for. Bit 8 j + l is lane l in round j.
struct Rounds {
    static constexpr int most = 7;
    int count = 0;
    std::uint8_t row[most][candidate_lanes];

    /// The pairs of each bit.
    struct Listed {
        std::uint8_t kind, row, column;   ///< of which lanes
        bool column_first, lesser_first;  ///< which of the features is the first
    };
    Listed listed[8 * most] = {};
    /// By SharedCorners::bits(): the bits of features that have a vertex in common.
    std::uint64_t incident[512] = {};

    bool of_impacts = false;  ///< what is asked for are vertices with faces and edges with edges

    explicit Rounds(const ListedKinds& kinds = {});
};

/// Writes the pairs of these bits.
inline void list_pairs(std::uint64_t bits, const Rounds& rounds, const CandidateRecord& a, const CandidateRecord& b,
                       PairEnds& next) {
    for (; bits; bits &= bits - 1) {
        const Rounds::Listed& listed = rounds.listed[std::countr_zero(bits)];
        const std::int32_t of_row = a.id[listed.row], of_column = b.id[listed.column];
        const bool swapped = listed.column_first || (listed.lesser_first && of_column < of_row);
        *next[listed.kind]++ = swapped ? Pair{of_column, of_row} : Pair{of_row, of_column};
    }
}

/// What of a row and a column perhaps overlaps, for some keys are equal.
struct UnsureHit {
    std::uint64_t bits;
    std::uint16_t row, column;  ///< as in Candidates
};

struct CandidateKernels {
    static constexpr std::int64_t most = 256;  ///< candidates at once

    /// Of candidates [begin, end): writes the pairs of features that overlap for certain and are not incident behind
    /// the ends of their lists, which it moves, and lists candidates with features of which that is not certain;
    /// returns how many. `record`: by physical row. Writes up to one more hit, and up to eight more pairs of a kind.
    std::size_t (*find)(const CandidateRecord* record, const CandidateChunk& candidates, std::int64_t begin,
                        std::int64_t end, const Rounds& rounds, PairEnds& next, UnsureHit* unsure);
};

/// The table for an instruction set; throws backend_unavailable if the build or the machine lacks it.
const CandidateKernels& candidate_kernels(Simd simd);

/// All tables that build and machine have, the plain one first: for tests.
std::vector<const CandidateKernels*> all_candidate_kernels();

extern const CandidateKernels scalar_candidates;

}  // namespace crumple::cpu
