#pragma once

// Stages `narrow` and `output` for candidate queries: find the pairs of features whose inflated boxes overlap. In each
// such pair, one feature is owned by each triangle of a pair that has survived the sweep. The features that come first
// in a pair have joint numbers, as in other feature queries (FirstOfKind).

#include "backends/cuda/candidates/candidate_records.h"
#include "backends/cuda/device/memory.h"
#include "backends/cuda/features/rows_by_kind.h"
#include "backends/cuda/stages/batched_clear.h"
#include "backends/cuda/stages/bounds.h"
#include "backends/cuda/stages/output.h"

namespace crumple::cuda {

/// Parameters of kernels, part of a graph's key (engine/graph_key.h).
struct CandidateParameters {
    CandidateConditions asked;
    FirstOfKind firsts;
    friend bool operator==(const CandidateParameters&, const CandidateParameters&) = default;
    void forget_places() {
        asked.forget_places();
        firsts = {};
    }
};

struct RankedCandidate {
    std::uint32_t first;  ///< in joint numbering (FirstOfKind)
    std::int32_t second;
    std::uint32_t rank;  ///< index among the pairs of the same first feature
};

struct CandidateHits {
    List<RankedCandidate> list;
    unsigned long long* by_first;
    FirstOfKind firsts;
};

/// Lists the hits among features of two triangles.
void find_candidates(const Geometry& geometry, cudaStream_t stream, const CandidateConditions& asked,
                     const CandidateMember* row, const List<Candidate>& survivors, const CandidateHits& hits,
                     Counters* counters);
/// Lists the hits within single triangles: two vertices, or a vertex and the opposite edge.
void find_within(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const PairSelection& pairs,
                 const CandidateConditions& asked, const CandidateHits& hits);

struct CandidateOutput : RowsByKind {
    using Key = std::int32_t;
    BucketedPair* bucketed;  ///< pairs by first feature; unsorted within a bucket

    void cut(ArenaLayout& cutter, const FirstOfKind& features, std::size_t most);

    __device__ std::int32_t first_of(unsigned long long i) const { return bucketed[i].first; }
    __device__ Key key(unsigned long long i) const { return bucketed[i].second; }
    __device__ TwoKeys<Key> two_keys(unsigned long long i) const { return keys_of(bucketed, i); }
    __device__ void set_key(unsigned long long i, Key key) const { bucketed[i].second = key; }
    __device__ void write(unsigned long long place, std::int32_t a, Key b) const {
        pairs[place] = firsts.pair(static_cast<std::uint32_t>(a), b);
    }
};

/// Turns the listed hits, which are counted by first feature, into rows of the result. For the last argument, see
/// order_buckets().
void write_feature_rows(const Geometry& geometry, cudaStream_t stream, const CandidateHits& hits,
                        const CandidateOutput& output, Counters* counters, Counters* told);

/// Computes the normaliser of the scene's box, and the inflation in normalised coordinates.
void make_normaliser(cudaStream_t stream, const SceneBox* box, double inflation, Inflation* widening,
                     Normaliser* normaliser);

}  // namespace crumple::cuda
