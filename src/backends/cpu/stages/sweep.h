#pragma once

// Stage `sweep` of one sorted leaf (stages/layout.h), in chunks: about 16,000 candidates, pairs of triangles whose
// boxes overlap, are collected and passed to the query's `narrow`, so that candidates stay in the cache and memory
// stays bounded however many there are. A chunk ends with the row that fills it, so it exceeds its nominal size by one
// row at most. leaves.cpp cuts large leaves into tiles, ranges of rows with about equal numbers of interval tests.

#include <algorithm>

#include "backends/cpu/stages/kernels.h"

namespace crumple::cpu {

inline constexpr std::int64_t chunk_columns = 1 << 14;

/// Reserves memory for a chunk of candidates of a leaf with this number of rows.
inline void reserve(std::int64_t rows, CandidateChunk& candidates) {
    const auto longest_row = static_cast<std::size_t>(std::min<std::int64_t>(rows, block_stride));
    candidates.column.resize_discard(static_cast<std::size_t>(chunk_columns) + longest_row + 4 * padding);
    candidates.row.resize_discard(candidates.column.size());
}

/// Sweeps rows [first, last) of a leaf: calls stop() before each chunk and narrow() after it, until stop() returns
/// true. `candidates` holds the current chunk, which may have no pairs.
template <class Stop, class Narrow>
void sweep_chunks(const StageKernels& kernels, const SortedLeaf& leaf, std::int64_t first, std::int64_t last,
                  CandidateChunk& candidates, Stop stop, Narrow narrow) {
    reserve(leaf.rows, candidates);
    for (std::int64_t block = 0; block < leaf.rows; block += block_stride) {
        const std::int64_t block_end = std::min(block + block_stride, leaf.rows) - 1;  // without the dummy
        const auto dummy = static_cast<std::uint16_t>(block_end - block);
        // Within one mesh, columns come after their row, so rows behind the block have no columns in it.
        const std::int64_t end = leaf.begin.empty() ? std::min(last, block_end) : last;
        for (std::int64_t row = first; row < end;) {
            if (stop()) return;
            candidates.rows = row;
            candidates.columns = block;
            candidates.count = candidates.pairs = 0;
            row = kernels.sweep(leaf, row, std::min(end, row + 65535), block_end, dummy, chunk_columns, candidates);
            narrow();
        }
    }
}

}  // namespace crumple::cpu
