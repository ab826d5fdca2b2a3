#pragma once

// Results about features and candidates: a list of pairs for each kind, one behind the other.

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "backends/cuda/device/memory.h"
#include "backends/cuda/input/known_mesh.h"
#include "backends/cuda/stages/clearing.h"
#include "backends/cuda/stages/output.h"
#include "queries/device_answer.h"

namespace crumple::cuda {

/// Features are numbered jointly, those that come first in a pair of one kind behind those of the kind before: then one
/// order of pairs is that of all lists. `base`: where those of each kind begin; and the end.
template <std::size_t kinds>
struct FirstFeatures {
    std::uint32_t base[kinds + 1] = {};
    friend bool operator==(const FirstFeatures&, const FirstFeatures&) = default;

    std::size_t all() const { return base[kinds]; }
    template <class Kind>
    CRUMPLE_HD std::uint32_t joint(Kind kind, std::int32_t feature) const {
        return base[static_cast<std::size_t>(kind)] + static_cast<std::uint32_t>(feature);
    }
    /// The pair whose first feature has that joint number.
    CRUMPLE_HD Pair pair(std::uint32_t joint, std::int32_t second) const {
        std::uint32_t first = 0;
        for (const std::uint32_t begin : base)
            if (begin <= joint) first = begin;
        return {static_cast<std::int32_t>(joint - first), second};
    }
};
using FirstOfKind = FirstFeatures<feature_kinds>;
using FirstOfCandidates = FirstFeatures<candidate_kinds>;

template <std::size_t kinds>
struct RowsByKind : RowsOfOutput {
    FirstFeatures<kinds> firsts;
    Pair* pairs;

    void cut(Cutter& c, const FirstFeatures<kinds>& features, std::size_t room) {
        firsts = features;
        capacity = room;
        part_capacity = cuda::part_capacity(room);
        offsets = c.take<unsigned long long>(firsts.all() + 1);
        by_tile = c.take<unsigned long long>(offset_tiles(firsts.all()));
        parts = c.take<RowPart>(part_capacity);
        pairs = c.take<Pair>(room);
    }
    void clear(Clearing& clearing) const {
        clearing.add(offsets, (firsts.all() + 1) * sizeof *offsets);
        clearing.add(by_tile, offset_tiles(firsts.all()) * sizeof *by_tile);
    }
    template <class Key>
    __device__ void set_flags(std::size_t, Key) const {}
};

/// Where the list of each kind begins among all rows; and the end.
template <std::size_t kinds>
struct ListEnds {
    std::array<unsigned long long, kinds + 1> at{};

    std::size_t all() const { return static_cast<std::size_t>(at[kinds]); }
    std::size_t begin(std::size_t kind) const { return static_cast<std::size_t>(at[kind]); }
    std::size_t count(std::size_t kind) const { return static_cast<std::size_t>(at[kind + 1] - at[kind]); }

    /// Reads the ends from rows that are complete on the device.
    void read(cudaStream_t stream, const RowsByKind<kinds>& rows) {
        for (std::size_t k = 0; k <= kinds; ++k)
            CRUMPLE_CUDA(cudaMemcpyAsync(&at[k], rows.offsets + rows.firsts.base[k], sizeof at[k],
                                         cudaMemcpyDeviceToHost, stream));
        CRUMPLE_CUDA(cudaStreamSynchronize(stream));
    }
    void append(std::size_t kind, std::size_t rows) { at[kind + 1] = at[kind] + rows; }
};

/// Appends the first `n` hits of a list of the device.
template <class Hit>
void download(cudaStream_t stream, const List<Hit>& hits, std::size_t n, Array<Hit>& found) {
    const std::size_t before = found.size();
    found.resize(before + n);
    copy_now(stream, found.data() + before, hits.data, n, cudaMemcpyDeviceToHost);
}

/// Calls take(kind, pair, hit) for all hits, in the order of the result.
template <std::size_t kinds, class Hit, class Take>
void for_each_sorted(Array<Hit>& found, const FirstFeatures<kinds>& firsts, Take take) {
    const auto pair = [](const Hit& hit) { return std::pair(hit.first, hit.second); };
    std::sort(found.begin(), found.end(), [&](const Hit& a, const Hit& b) { return pair(a) < pair(b); });
    std::size_t kind = 0;
    for (const Hit& hit : found) {
        while (hit.first >= firsts.base[kind + 1]) ++kind;
        take(kind, firsts.pair(hit.first, hit.second), hit);
    }
}

/// A result with so many rows, whose lists are still to be named.
inline DeviceAnswer shown_answer(const KnownMesh& known, std::size_t rows, const Statistics& statistics) {
    DeviceAnswer shown;
    shown.rows_needed = shown.count = static_cast<std::int64_t>(rows);
    shown.edges = known.edges;
    shown.edge_count = known.edge_count;
    shown.statistics = statistics;
    return shown;
}

/// Result of an incomplete replay.
inline DeviceAnswer incomplete_answer(const Counters& counters) {
    DeviceAnswer shown;
    shown.complete = false;
    shown.rows_needed = static_cast<std::int64_t>(counters.hits);
    shown.statistics.backend = "cuda";
    return shown;
}

inline void count_feature_tests(const Counters& c, Statistics& s) {
    s.edge_tests += static_cast<std::int64_t>(c.listed);
    for (const unsigned long long tests : c.tests) {
        s.double_tests += static_cast<std::int64_t>(tests);
        s.exact_tests += static_cast<std::int64_t>(tests);
    }
}

}  // namespace crumple::cuda
