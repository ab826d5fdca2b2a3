#pragma once

// Stage `output`: makes pairs in lexicographic order, offsets by first triangle, and hit flags. Pairs go to buckets by
// first triangle, which needs only the offsets; then each bucket, mostly short, is sorted. See docs/output.md.

#include "backends/cuda/device/runtime.h"
#include "backends/cuda/intersections/intersection_narrow.h"
#include "backends/cuda/stages/batched_clear.h"
#include "backends/cuda/stages/layout.h"
#include "scene/prepared_scene.h"

namespace crumple::cuda {

/// Part of a long row of the result. A row consists of all pairs with the same first element. In a short row each pair
/// finds its place by comparison with all others; a long one is sorted part by part, then merged.
struct RowPart {
    std::int32_t row;      ///< first element, a triangle or a feature
    std::uint32_t number;  ///< index of the part in its row
};

// Sets byte i to 1. Uses an atomic on its 32-bit word, because other threads may set bytes of the same word. `flags`
// must be aligned to a word.
__device__ inline void set_flag(std::uint8_t* flags, std::size_t i) {
    atomicOr(reinterpret_cast<unsigned*>(flags) + i / 4, 1u << 8 * (i % 4));
}

template <class Key>
struct alignas(2 * sizeof(Key)) TwoKeys {
    Key first, second;
};
/// Returns the keys of pairs i and i + 1, for even i, in one load.
__device__ inline TwoKeys<std::int32_t> keys_of(const BucketedPair* bucketed, unsigned long long i) {
    struct alignas(16) Two {
        BucketedPair pair[2];
    };
    const Two two = *reinterpret_cast<const Two*>(bucketed + i);
    return {two.pair[0].second, two.pair[1].second};
}

/// Offsets by first element, and parts of long rows: common to the outputs of all queries.
struct RowsOfOutput {
    unsigned long long* offsets;  ///< n + 1; before make_offsets(): number of pairs of each first element
    unsigned long long* tiles;    ///< scratch of make_offsets(), which requires it cleared (offset_tiles)
    RowPart* parts;               ///< parts of all long rows, in any order
    unsigned long long capacity;  ///< in pairs
    unsigned long long part_capacity;

    /// Returns the number of pairs, of n first elements; 0 if they exceed the capacity, because then some were not
    /// written.
    CRUMPLE_HD unsigned long long total(std::size_t n) const { return offsets[n] <= capacity ? offsets[n] : 0; }
};

/// Output of pairs of triangles.
struct OutputArrays : RowsOfOutput {
    using Key = std::int32_t;
    unsigned long long* next;  ///< offsets, incremented as pairs are written to their buckets (Hits::Mode::fill)
    BucketedPair* bucketed;    ///< pairs in their buckets; unsorted within a bucket
    Pair* pairs;
    /// Flags by triangle of the first and of the second mesh, of whole_words() bytes; the same array for a single mesh.
    std::uint8_t *hit, *hit_second;

    __device__ std::int32_t first_of(unsigned long long i) const { return bucketed[i].first; }
    __device__ Key key(unsigned long long i) const { return bucketed[i].second; }
    __device__ TwoKeys<Key> two_keys(unsigned long long i) const { return keys_of(bucketed, i); }
    __device__ void set_key(unsigned long long i, Key key) const { bucketed[i].second = key; }
    __device__ void flag_first(std::int32_t a) const { set_flag(hit, static_cast<std::size_t>(a)); }
    __device__ void flag_second(Key b) const { set_flag(hit_second, static_cast<std::size_t>(b)); }
    __device__ void write(unsigned long long place, std::int32_t a, Key b) const { pairs[place] = {a, b}; }
};

/// Returns the number of elements of RowsOfOutput::tiles for `firsts` first elements.
std::size_t offset_tiles(std::size_t firsts);
/// Returns the capacity of RowsOfOutput::parts that suffices for so many pairs.
std::size_t part_capacity(std::size_t pairs);

/// Returns the bytes to allocate for flags: whole words, because atomics on words set them.
std::size_t whole_words(std::size_t flags);

/// Turns counts by first element into offsets, and lists the parts of long rows. The templates here and below are
/// defined in output_kernel.h.
template <class OutputArrays>
void make_offsets(const Geometry& geometry, cudaStream_t stream, std::size_t firsts, const OutputArrays& output,
                  Counters* counters);
/// Lists only the parts of long rows, for offsets that have been computed before.
template <class OutputArrays>
void list_parts(const Geometry& geometry, cudaStream_t stream, std::size_t firsts, const OutputArrays& output,
                Counters* counters);
/// Writes the hits of the list to their buckets.
void fill_buckets(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const List<Hit>& hits,
                  const OutputArrays& output);
/// Adds the flags to `batch`: order_buckets() requires them cleared. Counters::parts has to be cleared, too.
void clear_flags(BatchedClear& batch, const PreparedScene& scene, const OutputArrays& output);
/// Sorts each bucket and sets the flags. Copies the counters to the last argument, host memory that the device can
/// write, unless it is null.
template <class OutputArrays>
void order_buckets(const Geometry& geometry, cudaStream_t stream, std::size_t firsts, const OutputArrays& output,
                   Counters* counters, Counters* told);

}  // namespace crumple::cuda
