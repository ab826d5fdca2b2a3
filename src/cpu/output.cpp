#include "cpu/output.h"

#include <algorithm>
#include <array>
#include <atomic>

namespace crumple::cpu {
namespace {

constexpr int bucket_bits = 12, bucket_size = 1 << bucket_bits;

void mark(Array<std::uint8_t>& flags, std::int32_t triangle) {
    // Several buckets may mark the same triangle at the same time.
    std::atomic_ref<std::uint8_t>(flags[static_cast<std::size_t>(triangle)]).store(1, std::memory_order_relaxed);
}

// Sorts the pairs of one bucket of first triangles, [first, last), into out[begin, ...) and writes their offsets.
void sort_bucket(const Pair* pairs, std::int64_t count, std::int32_t first, std::int32_t last, std::int64_t begin,
                 Collisions& result) {
    std::array<std::int64_t, bucket_size + 1> next{};
    for (std::int64_t i = 0; i < count; ++i) ++next[pairs[i].a - first + 1];
    for (int k = 0; k < bucket_size; ++k) next[k + 1] += next[k];
    for (std::int32_t a = first; a < last; ++a) result.offsets[a] = begin + next[a - first];
    Pair* out = result.pairs.data() + begin;
    for (std::int64_t i = 0; i < count; ++i) out[next[pairs[i].a - first]++] = pairs[i];
    // next[k] is now the end of row k.
    std::int64_t row_begin = 0;
    for (std::int32_t a = first; a < last; ++a) {
        const std::int64_t row_end = next[a - first];
        if (row_end > row_begin) result.hit[a] = 1;
        if (row_end - row_begin > 32) {
            std::sort(out + row_begin, out + row_end);
        } else {
            for (std::int64_t i = row_begin + 1; i < row_end; ++i) {
                const Pair pair = out[i];
                std::int64_t j = i;
                for (; j > row_begin && out[j - 1].b > pair.b; --j) out[j] = out[j - 1];
                out[j] = pair;
            }
        }
        row_begin = row_end;
    }
}

}  // namespace

void write_output(const Scene& scene, Workers& workers, std::span<const Array<Pair>* const> found,
                  OutputScratch& scratch, Collisions& result) {
    const auto n = static_cast<std::int32_t>(scene.triangles[0]);
    const auto second = static_cast<std::int32_t>(scene.between ? scene.triangles[0] : 0);
    const std::size_t buckets = (static_cast<std::size_t>(n) + bucket_size - 1) / bucket_size;

    scratch.histogram.assign(found.size() * buckets, 0);
    workers.parallel_for(found.size(), [&](std::size_t w, std::size_t) {
        std::int64_t* count = scratch.histogram.data() + w * buckets;
        for (const Pair& pair : *found[w]) ++count[pair.a >> bucket_bits];
    });
    std::int64_t total = 0;
    scratch.begin.resize_discard(buckets + 1);
    std::int64_t* begin = scratch.begin.data();
    for (std::size_t b = 0; b < buckets; ++b) {
        begin[b] = total;
        for (std::size_t w = 0; w < found.size(); ++w) {
            std::int64_t& count = scratch.histogram[w * buckets + b];
            const std::int64_t here = count;
            count = total;
            total += here;
        }
    }
    begin[buckets] = total;

    result.pairs.resize_discard(static_cast<std::size_t>(total));
    result.offsets.resize_discard(static_cast<std::size_t>(n) + 1);
    result.hit.assign(static_cast<std::size_t>(n), 0);
    result.hit_second.assign(static_cast<std::size_t>(scene.triangles[1]), 0);
    scratch.bucketed.resize_discard(static_cast<std::size_t>(total));
    workers.parallel_for(found.size(), [&](std::size_t w, std::size_t) {
        std::int64_t* next = scratch.histogram.data() + w * buckets;
        for (const Pair& pair : *found[w]) scratch.bucketed[next[pair.a >> bucket_bits]++] = {pair.a, pair.b - second};
    });
    result.offsets[static_cast<std::size_t>(n)] = total;
    workers.parallel_for(buckets, [&](std::size_t b, std::size_t) {
        const auto first = static_cast<std::int32_t>(b << bucket_bits);
        sort_bucket(scratch.bucketed.data() + begin[b], begin[b + 1] - begin[b], first,
                    static_cast<std::int32_t>(std::min<std::int64_t>(n, std::int64_t{first} + bucket_size)), begin[b],
                    result);
    });
    Array<std::uint8_t>& other = scene.between ? result.hit_second : result.hit;
    workers.parallel_for(buckets, [&](std::size_t b, std::size_t) {
        for (std::int64_t i = begin[b]; i < begin[b + 1]; ++i) mark(other, result.pairs[i].b);
    });
}

}  // namespace crumple::cpu
