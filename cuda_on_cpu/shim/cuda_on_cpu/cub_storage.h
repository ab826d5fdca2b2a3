#pragma once

// Common part of the counterparts of CUB's block and warp primitives. In each use all threads of the block, or all
// lanes of the logical warp, meet. They must have the same call site: the line that makes the primitive's object. As in
// CUB, there is no barrier after the use. Two measures find storage that is reused too early: before they meet, each
// thread writes a byte of the storage that another thread wrote in the last use (a race to ThreadSanitizer); when they
// have met, the whole storage is filled with rubbish, and so is whatever shares its memory in a union.

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "cuda_on_cpu/machine/block.h"
#include "cuda_on_cpu/machine/report.h"

namespace cuda_on_cpu {

template <unsigned Threads, std::size_t Bytes>
struct alignas(16) CubStorage {
    static_assert(Bytes >= Threads);
    unsigned char raw[Bytes];

    void touch() {
        Block& block = Block::current();
        raw[(block.rank() + block.next_use()) % Threads * (Bytes / Threads)] = 0;
    }
};

template <class Storage>
void check_in_shared(const Site& site, const Storage& storage) {
    const Block& block = Block::current();
    const auto* at = reinterpret_cast<const std::byte*>(&storage);
    if (at < block.shared() || at + sizeof(Storage) > block.shared() + block.shared_bytes())
        fail_in_kernel("%s at %s:%d: its storage is not in the block's shared memory", site.what, site.file, site.line);
}

template <class T, class Storage>
struct CubUse {
    T* mine;
    Storage* storage;
};

/// Waits for all threads of a block of `Threads`. The last one to arrive calls combine(all), with all[i] of thread i.
template <unsigned Threads, class Storage, class T, class F>
void block_primitive(const Site& site, Storage& storage, T& mine, F combine) {
    Block& block = Block::current();
    if (block.size() != Threads)
        fail_in_kernel("%s at %s:%d is for %u threads, but the block has %u", site.what, site.file, site.line, Threads,
                       block.size());
    check_in_shared(site, storage);
    storage.touch();
    CubUse<T, Storage> use{&mine, &storage};
    meet(site, false, use, [&](Contributions<CubUse<T, Storage>> uses) {
        T* all[Threads];
        for (unsigned i = 0; i < Threads; ++i) {
            all[i] = uses[i].mine;
            if (uses[i].storage != &storage)
                fail_in_kernel("%s at %s:%d: threads pass different storage", site.what, site.file, site.line);
        }
        combine(all);
        block.random().fill(&storage, sizeof storage);
    });
}

/// Waits for all lanes of a logical warp: `Lanes` lanes, a power of two, the first of which is a multiple of `Lanes`.
/// The last one to arrive calls combine(all), with all[i] of its lane i.
template <unsigned Lanes, class Storage, class T, class F>
void warp_primitive(const Site& site, Storage& storage, T& mine, F combine) {
    static_assert(Lanes >= 1 && Lanes <= 32 && (Lanes & (Lanes - 1)) == 0);
    Block& block = Block::current();
    check_in_shared(site, storage);
    storage.touch();
    const unsigned first = block.rank() % warp_size / Lanes * Lanes;
    const std::uint32_t mask = (Lanes == 32 ? ~0u : (1u << Lanes % 32) - 1) << first;
    CubUse<T, Storage> use{&mine, &storage};
    meet_in_warp(site, mask, false, use, [&](Contributions<CubUse<T, Storage>> uses) {
        T* all[Lanes];
        for (unsigned i = 0; i < Lanes; ++i) {
            all[i] = uses[first + i].mine;
            if (uses[first + i].storage != &storage)
                fail_in_kernel("%s at %s:%d: lanes pass different storage", site.what, site.file, site.line);
        }
        combine(all);
        block.random().fill(&storage, sizeof storage);
    });
}

/// Fills a result that CUB leaves undefined with rubbish. Types other than numbers, for which arbitrary bits may be
/// invalid (bool, pointers), stay unchanged.
template <class T>
void spoil(T& value) {
    if constexpr (std::is_arithmetic_v<T> && !std::is_same_v<T, bool>)
        Block::current().random().fill(&value, sizeof value);
}

// Scans over `count` threads, each of which has `items` consecutive items.

template <class T>
struct Scan {
    const T* in;
    T* out;
    int items;
    T aggregate;
};

template <class T, class Operation>
void inclusive_scan(Scan<T>* const* all, unsigned count, Operation operation) {
    T sum = all[0]->in[0];
    bool first = true;
    for (unsigned t = 0; t < count; ++t)
        for (int i = 0; i < all[t]->items; ++i) {
            if (!first) sum = operation(sum, all[t]->in[i]);
            first = false;
            all[t]->out[i] = sum;
        }
    for (unsigned t = 0; t < count; ++t) all[t]->aggregate = sum;
}

/// Without an initial value the first result is undefined. The aggregate leaves the initial value out.
template <class T, class Operation>
void exclusive_scan(Scan<T>* const* all, unsigned count, const T* initial, Operation operation) {
    T sum{}, aggregate{};
    bool any_sum = initial != nullptr, any_aggregate = false;
    if (initial) sum = *initial;
    for (unsigned t = 0; t < count; ++t)
        for (int i = 0; i < all[t]->items; ++i) {
            const T in = all[t]->in[i];
            if (any_sum)
                all[t]->out[i] = sum;
            else
                spoil(all[t]->out[i]);
            sum = any_sum ? operation(sum, in) : in;
            aggregate = any_aggregate ? operation(aggregate, in) : in;
            any_sum = any_aggregate = true;
        }
    for (unsigned t = 0; t < count; ++t) all[t]->aggregate = aggregate;
}

/// Sum as in CUB and on a device: integers are added as unsigned numbers, so that they wrap round.
struct Plus {
    template <class T>
    T operator()(const T& a, const T& b) const {
        if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>)
            return static_cast<T>(static_cast<std::make_unsigned_t<T>>(a) + static_cast<std::make_unsigned_t<T>>(b));
        else
            return static_cast<T>(a + b);
    }
};

}  // namespace cuda_on_cpu
