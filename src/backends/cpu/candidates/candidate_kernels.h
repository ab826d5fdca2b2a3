#pragma once

// Inner loop of candidate queries on the cpu, as tables like those of the stages (backends/cpu/stages/kernels.h): one
// in plain C++, and one for each SIMD instruction set (candidate_lanes.cpp). All tables list the same pairs. A leaf is
// a small set of triangles that one sweep searches. Its candidates are the pairs of triangles, a row and a column of
// the sweep, whose boxes overlap (stages/layout.h).

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

/// End of each kind's list, where the next pair is written.
using PairEnds = std::array<Pair*, candidate_kinds>;

/// Schedule of tests between the features of two triangles, a row and a column of the sweep. A lane of a triangle's
/// CandidateRecord has one of its features. In each round, every lane of the column is tested against one lane of the
/// row, or against lane 7, which overlaps nothing. Together, the rounds test all pairs of the requested kinds. In masks
/// of tests, bit 8 j + l stands for lane l of the column in round j.
struct LaneSteps {
    static constexpr int most = 7;
    int count = 0;
    std::uint8_t row[most][candidate_lanes];  ///< by round and lane of the column: lane of the row

    /// Pair of features that a bit stands for.
    struct Listed {
        std::uint8_t kind, row, column;   ///< CandidateKind, and the lanes of its features in row and column
        bool column_first, lesser_first;  ///< the column's feature, or the lower id, comes first; else the row's does
    };
    Listed listed[8 * most] = {};
    /// Bits of the tests whose features have a common vertex, indexed by SharedCorners::bits() of the row and the
    /// column; 0 if such pairs are listed, too.
    std::uint64_t incident[512] = {};

    /// True if exactly vertex_face and edge_edge are requested, without pairs that have a common vertex.
    bool has_impact_kinds_only = false;

    /// `neighbours`: also lists pairs with a common vertex.
    explicit LaneSteps(const RequestedKinds& kinds = {}, bool neighbours = false);
};

/// Writes the pairs of features of a (row) and b (column) that the bits stand for (LaneSteps), and advances `next`.
inline void list_pairs(std::uint64_t bits, const LaneSteps& rounds, const CandidateRecord& a, const CandidateRecord& b,
                       PairEnds& next) {
    for (; bits; bits &= bits - 1) {
        const LaneSteps::Listed& listed = rounds.listed[std::countr_zero(bits)];
        const std::int32_t of_row = a.id[listed.row], of_column = b.id[listed.column];
        const bool swapped = listed.column_first || (listed.lesser_first && of_column < of_row);
        *next[listed.kind]++ = swapped ? Pair{of_column, of_row} : Pair{of_row, of_column};
    }
}

/// Pairs of features of a row and a column whose boxes may or may not overlap: some of their rounded coordinates (keys,
/// candidate_record.h) are equal, which decides nothing.
struct UncertainTests {
    std::uint64_t bits;         ///< mask of tests, as in LaneSteps
    std::uint16_t row, column;  ///< as in CandidateChunk
};

struct CandidateKernels {
    static constexpr std::int64_t most = 256;  ///< largest number of candidates per call

    /// Tests the candidates [begin, end). Appends the pairs of features whose boxes certainly overlap, and which have
    /// no common vertex, to the lists that end at `next`, and advances `next`. Writes candidates with uncertain pairs
    /// to `unsure`, and returns their number. `record`: the leaf's records by physical row (stages/layout.h). May write
    /// one more element of `unsure`, and eight more pairs of each kind.
    std::size_t (*find)(const CandidateRecord* record, const CandidateChunk& candidates, std::int64_t begin,
                        std::int64_t end, const LaneSteps& rounds, PairEnds& next, UncertainTests* unsure);
};

/// Returns the table of an instruction set. Throws Error (backend_unavailable) if the build or the machine lacks it.
const CandidateKernels& candidate_kernels(Simd simd);

/// Returns all tables that both the build and the machine support, the plain one first. For tests.
std::vector<const CandidateKernels*> all_candidate_kernels();

extern const CandidateKernels scalar_candidates;

}  // namespace crumple::cpu
