#include "backends/cpu/stages/sort_pairs.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace crumple::cpu {
namespace {

constexpr int most_bucket_bits = 12, most_digit_bits = 11;

// Returns log2 of the bucket size. Small buckets divide the work evenly, but need a long histogram for each piece.
int bucket_bits_for(std::int32_t firsts) {
    int bits = 10;
    while (bits < most_bucket_bits && firsts >> bits > 2048) ++bits;
    return bits;
}

// Replaces the count of keys with each digit by the place of the first such key.
void to_places(std::int64_t* count, std::int64_t digits) {
    std::int64_t sum = 0;
    for (std::int64_t digit = 0; digit < digits; ++digit) sum += std::exchange(count[digit], sum);
}

// Packs a pair of a bucket in one number: the second index in the upper bits, the first index relative to the bucket's
// first in the lower ones. With 32-bit keys, this halves the data that moves.
template <class Key>
struct Packing {
    int bucket_bits;
    Key operator()(const Pair& pair, std::int32_t before_seconds) const {
        const auto second = static_cast<Key>(pair.b - before_seconds);
        return static_cast<Key>(second << bucket_bits | (static_cast<Key>(pair.a) & ((Key{1} << bucket_bits) - 1)));
    }
    std::int32_t first(Key key) const { return static_cast<std::int32_t>(key & ((Key{1} << bucket_bits) - 1)); }
    std::int32_t second(Key key) const { return static_cast<std::int32_t>(key >> bucket_bits); }
};

// Sorts the pairs of one bucket of first indices, [first, last), into out[begin, ...) and writes their offsets:
// counting sorts by the digits of the second index, an even number of passes to and fro, then by the first index. All
// passes are stable, and are counted at once. The last pass over digits prefetches the output.
template <class Key>
void sort_bucket(Key* keys, Key* to, std::int64_t count, Packing<Key> packing, std::int32_t first, std::int32_t last,
                 int second_bits, std::int64_t begin, Pair* out, std::int64_t* offsets) {
    if (count == 0) {
        std::fill_n(offsets + first, last - first, begin);
        return;
    }
    const int passes = second_bits <= 2 * most_digit_bits ? 2 : 4, bits = (second_bits + passes - 1) / passes;
    const std::int32_t digits = 1 << bits, firsts = last - first;
    const Key mask = static_cast<Key>(digits - 1);
    const auto digit = [&](Key key, int pass) { return key >> (packing.bucket_bits + pass * bits) & mask; };
    std::int64_t next_digit[4][1 << most_digit_bits], next_first[1 << most_bucket_bits];
    for (int pass = 0; pass < passes; ++pass) std::fill_n(next_digit[pass], digits, 0);
    std::fill_n(next_first, firsts, 0);
    for (std::int64_t i = 0; i < count; ++i) {
        for (int pass = 0; pass < passes; ++pass) ++next_digit[pass][digit(keys[i], pass)];
        ++next_first[packing.first(keys[i])];
    }
    out += begin;
    for (int pass = 0; pass < passes; ++pass, std::swap(keys, to)) {
        to_places(next_digit[pass], digits);
        std::int64_t* next = next_digit[pass];
        const int shift = packing.bucket_bits + pass * bits;
        if (pass == passes - 1) {
            for (std::int64_t i = 0; i < count; ++i) {
                if (i % 8 == 0) __builtin_prefetch(out + i, 1);
                to[next[keys[i] >> shift & mask]++] = keys[i];
            }
        } else {
            for (std::int64_t i = 0; i < count; ++i) to[next[keys[i] >> shift & mask]++] = keys[i];
        }
    }
    to_places(next_first, firsts);
    for (std::int32_t k = 0; k < firsts; ++k) offsets[first + k] = begin + next_first[k];
    for (std::int64_t i = 0; i < count; ++i) {
        const std::int32_t k = packing.first(keys[i]);
        out[next_first[k]++] = {first + k, packing.second(keys[i])};
    }
}

template <class Key>
void sort(Workers& workers, std::span<const Array<Pair>* const> found, PairCounts counts, int second_bits,
          PairSorting& scratch, Array<Key>& keys, Array<Pair>& pairs, Array<std::int64_t>& offsets,
          ConcurrentTask beside) {
    const std::int32_t n = counts.firsts;
    const int bucket_bits = bucket_bits_for(n);
    const Packing<Key> packing{bucket_bits};
    const std::int64_t bucket_size = std::int64_t{1} << bucket_bits;
    const auto buckets = static_cast<std::size_t>((n + bucket_size - 1) / bucket_size);

    // The workers' lists differ in length, so they are cut into pieces. Pieces are at most as long as a task may take
    // between two checks for cancellation.
    std::size_t all = 0;
    for (const auto* list : found) all += list->size();
    const std::size_t piece_size = std::clamp<std::size_t>(all / (8 * found.size()) + 1, 8192, 1 << 20);
    const std::size_t most_pieces = all / piece_size + found.size();  // enough for any distribution among workers
    scratch.pieces.clear();
    scratch.pieces.reserve(most_pieces);
    scratch.histogram.reserve(most_pieces * buckets);
    for (const auto* list : found)
        for (std::size_t i = 0; i < list->size(); i += piece_size)
            scratch.pieces.push_back({list->data() + i, std::min(piece_size, list->size() - i)});
    const std::size_t pieces = scratch.pieces.size();
    scratch.histogram.assign(pieces * buckets, 0);
    workers.parallel_for(pieces, [&](std::size_t p, std::size_t) {
        std::int64_t* count = scratch.histogram.data() + p * buckets;
        for (const Pair& pair : scratch.pieces[p]) ++count[pair.a >> bucket_bits];
    });
    std::int64_t total = 0;
    scratch.begin.resize_discard(buckets + 1);
    std::int64_t* begin = scratch.begin.data();
    for (std::size_t b = 0; b < buckets; ++b) {
        begin[b] = total;
        for (std::size_t p = 0; p < pieces; ++p) {
            std::int64_t& count = scratch.histogram[p * buckets + b];
            const std::int64_t here = count;
            count = total;
            total += here;
        }
    }
    begin[buckets] = total;

    pairs.resize_discard(static_cast<std::size_t>(total));
    offsets.resize_discard(static_cast<std::size_t>(n) + 1);
    // Scratch is per worker, so that it stays in the cache, unless buckets are so unequal that scratch per bucket takes
    // less memory.
    std::int64_t largest = 0;
    for (std::size_t b = 0; b < buckets; ++b) largest = std::max(largest, begin[b + 1] - begin[b]);
    const bool by_worker = !counts.low_memory && largest * workers.workers() < total;
    keys.resize_discard(static_cast<std::size_t>(total + (by_worker ? largest * workers.workers() : total)));
    workers.parallel_for(pieces, [&](std::size_t p, std::size_t) {
        std::int64_t* next = scratch.histogram.data() + p * buckets;
        for (const Pair& pair : scratch.pieces[p])
            keys[next[pair.a >> bucket_bits]++] = packing(pair, counts.before_seconds);
    });
    offsets[static_cast<std::size_t>(n)] = total;
    workers.parallel_for(buckets + 1, [&](std::size_t task, std::size_t worker) {
        if (task == 0) return beside(scratch.pieces.span());
        const std::size_t b = task - 1;
        const auto first = static_cast<std::int32_t>(b << bucket_bits);
        const auto last = static_cast<std::int32_t>(std::min<std::int64_t>(n, first + bucket_size));
        Key* own = keys.data() + begin[b];
        Key* other = keys.data() + total + (by_worker ? largest * static_cast<std::int64_t>(worker) : begin[b]);
        sort_bucket(own, other, begin[b + 1] - begin[b], packing, first, last, second_bits, begin[b], pairs.data(),
                    offsets.data());
    });
}

}  // namespace

void sort_pairs(Workers& workers, std::span<const Array<Pair>* const> found, PairCounts counts, PairSorting& scratch,
                Array<Pair>& pairs, Array<std::int64_t>& offsets, ConcurrentTask beside) {
    const auto second_bits = static_cast<int>(std::bit_width(static_cast<std::uint32_t>(counts.seconds)));
    if (second_bits + bucket_bits_for(counts.firsts) <= 32)
        sort(workers, found, counts, second_bits, scratch, scratch.keys32, pairs, offsets, beside);
    else
        sort(workers, found, counts, second_bits, scratch, scratch.keys64, pairs, offsets, beside);
}

}  // namespace crumple::cpu
