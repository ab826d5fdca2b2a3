#pragma once

// Stage `output` for feature queries: the lists of all kinds in order, concatenated, with their values.

#include "backends/cuda/device/memory.h"
#include "backends/cuda/features/feature_narrow.h"
#include "backends/cuda/stages/output.h"

namespace crumple::cuda {

/// Arrays on the device in which the rows of impacts or near pairs are made, with the keys by which they are sorted.
/// CandidateOutput is that of candidates.
struct FeatureOutput : RowsByKind {
    /// Upper half: second feature of a pair; lower half: index of the pair in the list of hits.
    using Key = std::uint64_t;
    Key* second;            ///< by pair, in buckets by first feature
    const RankedHit* hits;  ///< the list of hits

    void cut(ArenaLayout& cutter, const FirstOfKind& features, std::size_t most);

    __device__ std::uint32_t first_of(unsigned long long i) const {
        return hits[static_cast<std::uint32_t>(second[i])].first;
    }
    __device__ Key key(unsigned long long i) const { return second[i]; }
    __device__ TwoKeys<Key> two_keys(unsigned long long i) const {
        return *reinterpret_cast<const TwoKeys<Key>*>(second + i);
    }
    __device__ void set_key(unsigned long long i, Key key) const { second[i] = key; }
    __device__ void write(unsigned long long place, std::int32_t first, Key key) const {
        const RankedHit& hit = hits[static_cast<std::uint32_t>(key)];
        pairs[place] = firsts.pair(static_cast<std::uint32_t>(first), static_cast<std::int32_t>(key >> 32));
        value[place] = hit.value;
        flag[place] = static_cast<std::uint8_t>(hit.flag);
    }
};

/// Turns listed hits, counted by first feature, into the result. For the last argument, see order_buckets().
void write_feature_rows(const Geometry& geometry, cudaStream_t stream, const FeatureHits& hits,
                        const FeatureOutput& output, Counters* counters, Counters* told);

/// Earliest impact among listed hits: the least value, ties broken by the order of the result.
struct Earliest {
    /// Bits of the toi; first feature, in joint numbering (FirstOfKind), in the upper half, and second in the lower.
    unsigned long long value, pair;
    unsigned long long flag;
};
void clear(BatchedClear& batch, Earliest* earliest);
/// Finds the earliest impact. Copies the counters to the last argument, host memory that the device can write, unless
/// it is null.
void find_earliest(const Geometry& geometry, cudaStream_t stream, const FeatureHits& hits, Earliest* earliest,
                   Counters* counters, Counters* told);

}  // namespace crumple::cuda
