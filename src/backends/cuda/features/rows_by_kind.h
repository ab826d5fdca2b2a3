#pragma once

// Rows of feature queries: the lists of all kinds, concatenated.

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "backends/cuda/device/memory.h"
#include "backends/cuda/stages/batched_clear.h"
#include "backends/cuda/stages/output.h"
#include "queries/feature_request.h"

namespace crumple::cuda {

/// Joint numbering of the features that come first in a pair, kind after kind: ordering all pairs by joint number
/// orders all lists at once. `base`: first joint number of each CandidateKind; and the end. A kind that is not listed
/// has no numbers.
struct FirstOfKind {
    std::uint32_t base[candidate_kinds + 1] = {};
    friend bool operator==(const FirstOfKind&, const FirstOfKind&) = default;

    std::size_t all() const { return base[candidate_kinds]; }
    CRUMPLE_HD std::uint32_t joint(CandidateKind kind, std::int32_t feature) const {
        return base[static_cast<std::size_t>(kind)] + static_cast<std::uint32_t>(feature);
    }
    CRUMPLE_HD std::uint32_t joint(FeatureKind kind, std::int32_t feature) const {
        return joint(candidate_kind(kind), feature);
    }
    /// Returns the pair whose first feature has that joint number.
    CRUMPLE_HD Pair pair(std::uint32_t joint, std::int32_t second) const {
        std::uint32_t first = 0;
        for (const std::uint32_t begin : base)
            if (begin <= joint) first = begin;
        return {static_cast<std::int32_t>(joint - first), second};
    }
    /// Returns the kind of an impact whose first feature has that joint number.
    FeatureKind kind_of_impact(std::uint32_t joint) const {
        auto kind = FeatureKind::vertex_face;
        for (const auto other : {FeatureKind::edge_edge, FeatureKind::vertex_edge, FeatureKind::vertex_vertex})
            if (this->joint(other, 0) <= joint) kind = other;
        return kind;
    }
};

struct RowsByKind : RowsOfOutput {
    FirstOfKind firsts;
    Pair* pairs;
    double* value;       ///< null for candidates
    std::uint8_t* flag;  ///< null for candidates

    /// Takes the lists of the result from the cutter. `valued`: true if rows have values and flags.
    void place_row_lists(ArenaLayout& c, std::size_t most, bool valued) {
        pairs = c.take<Pair>(most);
        value = valued ? c.take<double>(most) : nullptr;
        flag = valued ? c.take<std::uint8_t>(most) : nullptr;
    }
    void cut(ArenaLayout& c, const FirstOfKind& features, std::size_t most, bool valued) {
        firsts = features;
        capacity = most;
        part_capacity = cuda::part_capacity(most);
        offsets = c.take<unsigned long long>(firsts.all() + 1);
        tiles = c.take<unsigned long long>(offset_tiles(firsts.all()));
        parts = c.take<RowPart>(part_capacity);
        place_row_lists(c, most, valued);
    }
    void clear(BatchedClear& batch) const {
        batch.add(offsets, (firsts.all() + 1) * sizeof *offsets);
        batch.add(tiles, offset_tiles(firsts.all()) * sizeof *tiles);
    }
    __device__ void flag_first(std::int32_t) const {}
    template <class Key>
    __device__ void flag_second(Key) const {}
};

/// First row of each kind's list among all rows; and the end.
struct ListEnds {
    std::array<unsigned long long, candidate_kinds + 1> at{};

    std::size_t all() const { return static_cast<std::size_t>(at[candidate_kinds]); }
    std::size_t begin(std::size_t kind) const { return static_cast<std::size_t>(at[kind]); }
    std::size_t count(std::size_t kind) const { return static_cast<std::size_t>(at[kind + 1] - at[kind]); }

    /// Reads the ends from rows that are complete on the device.
    void read(cudaStream_t stream, const RowsByKind& rows) {
        const auto& base = rows.firsts.base;
        at[0] = 0;
        for (std::size_t k = 1; k <= candidate_kinds; ++k)
            if (base[k] != base[k - 1])
                CRUMPLE_CUDA(
                    cudaMemcpyAsync(&at[k], rows.offsets + base[k], sizeof at[k], cudaMemcpyDeviceToHost, stream));
        CRUMPLE_CUDA(cudaStreamSynchronize(stream));
        for (std::size_t k = 1; k <= candidate_kinds; ++k)
            if (base[k] == base[k - 1]) at[k] = at[k - 1];
    }
    void append(std::size_t kind, std::size_t rows) { at[kind + 1] = at[kind] + rows; }
};

/// Appends the first `n` hits of a list on the device to `found`.
template <class Hit>
void download(cudaStream_t stream, const List<Hit>& hits, std::size_t n, Array<Hit>& found) {
    const std::size_t before = found.size();
    found.resize(before + n);
    copy_now(stream, found.data() + before, hits.data, n, cudaMemcpyDeviceToHost);
}

/// Sorts the hits and calls take(kind, pair, hit) for each, in the order of the result.
template <class Hit, class Take>
void for_each_sorted(Array<Hit>& found, const FirstOfKind& firsts, Take take) {
    const auto pair = [](const Hit& hit) { return std::pair(hit.first, hit.second); };
    std::sort(found.begin(), found.end(), [&](const Hit& a, const Hit& b) { return pair(a) < pair(b); });
    std::size_t kind = 0;
    for (const Hit& hit : found) {
        while (hit.first >= firsts.base[kind + 1]) ++kind;
        take(static_cast<CandidateKind>(kind), firsts.pair(hit.first, hit.second), hit);
    }
}

}  // namespace crumple::cuda
