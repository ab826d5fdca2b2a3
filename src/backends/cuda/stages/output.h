#pragma once

// Stage `output`: pairs in lexicographic order, offsets by first triangle, hit flags. Pairs are bucketed by their first
// triangle, which needs the offsets only; the few of one bucket are then put in order. See docs/output.md.

#include "backends/cuda/device/runtime.h"
#include "backends/cuda/intersections/intersection_narrow.h"
#include "backends/cuda/stages/clearing.h"
#include "backends/cuda/stages/layout.h"
#include "scene/prepared_scene.h"

namespace crumple::cuda {

/// A part of a row of the answer that is longer than its pairs can put in order by looking at each other.
struct RowPart {
    std::int32_t row;  ///< first triangle
    std::uint32_t number;
};

// Sets one byte. Many threads may set the same one at once, so it is done by an atomic on its word.
__device__ inline void set_flag(std::uint8_t* flags, std::size_t i) {
    atomicOr(reinterpret_cast<unsigned*>(flags) + i / 4, 1u << 8 * (i % 4));
}

template <class Key>
struct alignas(2 * sizeof(Key)) TwoKeys {
    Key first, second;
};
/// Keys of two neighbours, of which the first has an even place: read at once.
__device__ inline TwoKeys<std::int32_t> keys_of(const BucketedPair* bucketed, unsigned long long i) {
    struct alignas(16) Two {
        BucketedPair pair[2];
    };
    const Two two = *reinterpret_cast<const Two*>(bucketed + i);
    return {two.pair[0].second, two.pair[1].second};
}

/// Numbers by first element, and the parts of long rows, as any output has them.
struct RowsOfOutput {
    unsigned long long* offsets;  ///< n + 1; before: pairs of each first element
    unsigned long long* tiles;    ///< cleared; what make_offsets() counts of each `offset_tile` first elements
    RowPart* parts;               ///< of all long rows, in any order
    unsigned long long capacity;  ///< of pairs
    unsigned long long part_capacity;

    /// Pairs of the answer; none if there are more than fit, since not all of them were kept.
    CRUMPLE_HD unsigned long long total(std::size_t n) const { return offsets[n] <= capacity ? offsets[n] : 0; }
};

/// Pairs of triangles.
struct OutputArrays : RowsOfOutput {
    using Key = std::int32_t;
    unsigned long long* next;  ///< offsets, counted up while pairs are written to their buckets
    BucketedPair* bucketed;    ///< in no order within a bucket
    Pair* pairs;
    std::uint8_t *hit, *hit_second;  ///< room for a multiple of four bytes; the second mesh's, or the same

    __device__ std::int32_t first_of(unsigned long long i) const { return bucketed[i].first; }
    __device__ Key key(unsigned long long i) const { return bucketed[i].second; }
    __device__ TwoKeys<Key> two_keys(unsigned long long i) const { return keys_of(bucketed, i); }
    __device__ void set_key(unsigned long long i, Key key) const { bucketed[i].second = key; }
    __device__ void set_flags(std::size_t a, Key b) const {
        set_flag(hit, a);
        set_flag(hit_second, static_cast<std::size_t>(b));
    }
    __device__ void write(unsigned long long place, std::int32_t a, Key b) const { pairs[place] = {a, b}; }
};

/// Words of RowsOfOutput::tiles, for so many first elements.
std::size_t offset_tiles(std::size_t firsts);
std::size_t part_capacity(std::size_t pairs);

/// Bytes for so many flags: they are set by atomics on words.
std::size_t whole_words(std::size_t flags);

/// Turns numbers by first element into offsets, and lists the parts of long rows. Defined, as those that follow are, in
/// output_kernel.h.
template <class OutputArrays>
void make_offsets(const Geometry& geometry, cudaStream_t stream, std::size_t firsts, const OutputArrays& output,
                  Counters* counters);
/// Lists them where the offsets are known.
template <class OutputArrays>
void list_parts(const Geometry& geometry, cudaStream_t stream, std::size_t firsts, const OutputArrays& output,
                Counters* counters);
/// Writes the list's hits to their buckets.
void fill_buckets(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const List<Hit>& hits,
                  const OutputArrays& output);
/// What order_buckets() finds cleared, beside the list of parts.
void clear_flags(Clearing& clearing, const PreparedScene& scene, const OutputArrays& output);
/// Puts each bucket in order and sets the flags. `told`, unless it is null, is given a copy of the counters: memory of
/// the host that the device can write.
template <class OutputArrays>
void order_buckets(const Geometry& geometry, cudaStream_t stream, std::size_t firsts, const OutputArrays& output,
                   Counters* counters, Counters* told);

}  // namespace crumple::cuda
