#pragma once

// Votes, shuffles, matches and reductions among the lanes of a warp that a mask names. Only __syncwarp orders memory.
// Values from lanes outside the mask are rubbish, as CUDA warns.

#include <bit>
#include <climits>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "cuda_on_cpu/machine/block.h"
#include "cuda_on_cpu/machine/report.h"

inline void __syncwarp(unsigned mask = 0xffffffffu, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
    cuda_on_cpu::Block::current().meet_in_warp({"__syncwarp", file, line}, mask, true, nullptr, nullptr, nullptr);
}

/// Returns the caller's lane alone. CUDA promises no more: which lanes run together is unspecified.
inline unsigned __activemask() { return 1u << cuda_on_cpu::Block::current().rank() % cuda_on_cpu::warp_size; }

namespace cuda_on_cpu {

template <class F>
void for_each_lane(std::uint32_t mask, F f) {
    for (; mask; mask &= mask - 1) f(static_cast<unsigned>(std::countr_zero(mask)));
}

inline std::uint32_t ballot(const Site& site, std::uint32_t mask, bool predicate) {
    struct Mine {
        bool predicate;
        std::uint32_t result;
    } mine{predicate, 0};
    meet_in_warp(site, mask, false, mine, [mask](Contributions<Mine> all) {
        std::uint32_t result = 0;
        for_each_lane(mask, [&](unsigned i) { result |= static_cast<std::uint32_t>(all[i].predicate) << i; });
        for_each_lane(mask, [&](unsigned i) { all[i].result = result; });
    });
    return mine.result;
}

/// Returns the value of lane `source`: rubbish if the mask lacks that lane, and the caller's own value if `source` is
/// negative, which stands for a lane outside the caller's segment.
template <class T>
T shuffle(const Site& site, std::uint32_t mask, const T& value, int source) {
    static_assert(std::is_arithmetic_v<T> && sizeof(T) >= 4 && sizeof(T) <= 8, "CUDA shuffles 4 or 8 bytes");
    struct Mine {
        T value, result;
        int source;
    } mine{value, value, source};
    Random& random = Block::current().random();
    meet_in_warp(site, mask, false, mine, [mask, &random](Contributions<Mine> all) {
        for_each_lane(mask, [&](unsigned i) {
            Mine& m = all[i];
            if (m.source < 0) return;
            if (mask >> m.source & 1)
                m.result = all[static_cast<unsigned>(m.source)].value;
            else
                random.fill(&m.result, sizeof(T));
        });
    });
    return mine.result;
}

/// Position of the caller: its lane, and the first lane of its segment of `width` lanes.
struct Segment {
    int lane, first, width;
    Segment(const Site& site, int width_) : width(width_) {
        if (width < 1 || width > 32 || (width & (width - 1)) != 0)
            fail_in_kernel("%s at %s:%d: the width %d is not a power of two from 1 to 32", site.what, site.file,
                           site.line, width);
        lane = static_cast<int>(Block::current().rank() % warp_size);
        first = lane / width * width;
    }
};

/// Combines the values of all lanes of the mask, lowest lane first.
template <class T, class Operation>
T reduce(const Site& site, std::uint32_t mask, T value, Operation operation) {
    meet_in_warp(site, mask, false, value, [&](Contributions<T> all) {
        const auto first = static_cast<unsigned>(std::countr_zero(mask));
        T result = all[first];
        for_each_lane(mask & (mask - 1), [&](unsigned i) { result = operation(result, all[i]); });
        for_each_lane(mask, [&](unsigned i) { all[i] = result; });
    });
    return value;
}

/// Returns the lanes of the mask whose values have the same bits as the caller's.
template <class T>
std::uint32_t match(const Site& site, std::uint32_t mask, const T& value) {
    static_assert(std::is_arithmetic_v<T> && sizeof(T) >= 4 && sizeof(T) <= 8, "CUDA matches 4 or 8 bytes");
    struct Mine {
        T value;
        std::uint32_t result;
    } mine{value, 0};
    meet_in_warp(site, mask, false, mine, [mask](Contributions<Mine> all) {
        for_each_lane(mask, [&](unsigned i) {
            for_each_lane(mask, [&](unsigned j) {
                const bool equal = std::memcmp(&all[i].value, &all[j].value, sizeof(T)) == 0;
                all[i].result |= static_cast<std::uint32_t>(equal) << j;
            });
        });
    });
    return mine.result;
}

template <class T>
concept Reducible = std::same_as<T, int> || std::same_as<T, unsigned>;

}  // namespace cuda_on_cpu

inline unsigned __ballot_sync(unsigned mask, int predicate, const char* file = __builtin_FILE(),
                              int line = __builtin_LINE()) {
    return cuda_on_cpu::ballot({"__ballot_sync", file, line}, mask, predicate != 0);
}
inline int __any_sync(unsigned mask, int predicate, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
    return cuda_on_cpu::ballot({"__any_sync", file, line}, mask, predicate != 0) != 0;
}
inline int __all_sync(unsigned mask, int predicate, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
    return cuda_on_cpu::ballot({"__all_sync", file, line}, mask, predicate != 0) == mask;
}

template <class T>
T __shfl_sync(unsigned mask, T value, int source, int width = 32, const char* file = __builtin_FILE(),
              int line = __builtin_LINE()) {
    const cuda_on_cpu::Site site{"__shfl_sync", file, line};
    const cuda_on_cpu::Segment segment(site, width);
    return cuda_on_cpu::shuffle(site, mask, value, segment.first + (source & (width - 1)));
}
template <class T>
T __shfl_up_sync(unsigned mask, T value, unsigned delta, int width = 32, const char* file = __builtin_FILE(),
                 int line = __builtin_LINE()) {
    const cuda_on_cpu::Site site{"__shfl_up_sync", file, line};
    const cuda_on_cpu::Segment s(site, width);
    const int source = delta > 31 ? -1 : s.lane - static_cast<int>(delta);
    return cuda_on_cpu::shuffle(site, mask, value, source < s.first ? -1 : source);
}
template <class T>
T __shfl_down_sync(unsigned mask, T value, unsigned delta, int width = 32, const char* file = __builtin_FILE(),
                   int line = __builtin_LINE()) {
    const cuda_on_cpu::Site site{"__shfl_down_sync", file, line};
    const cuda_on_cpu::Segment s(site, width);
    const int source = delta > 31 ? 32 : s.lane + static_cast<int>(delta);
    return cuda_on_cpu::shuffle(site, mask, value, source >= s.first + width ? -1 : source);
}
template <class T>
T __shfl_xor_sync(unsigned mask, T value, int lanes, int width = 32, const char* file = __builtin_FILE(),
                  int line = __builtin_LINE()) {
    const cuda_on_cpu::Site site{"__shfl_xor_sync", file, line};
    const cuda_on_cpu::Segment s(site, width);
    // A lane of an earlier segment may be read, one of a later segment may not.
    const int source = s.lane ^ (lanes & 31);
    return cuda_on_cpu::shuffle(site, mask, value, source >= s.first + width ? -1 : source);
}

template <class T>
unsigned __match_any_sync(unsigned mask, T value, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
    return cuda_on_cpu::match({"__match_any_sync", file, line}, mask, value);
}
template <class T>
unsigned __match_all_sync(unsigned mask, T value, int* predicate, const char* file = __builtin_FILE(),
                          int line = __builtin_LINE()) {
    *predicate = cuda_on_cpu::match({"__match_all_sync", file, line}, mask, value) == mask;
    return *predicate ? mask : 0;
}

template <cuda_on_cpu::Reducible T>
T __reduce_add_sync(unsigned mask, T value, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
    // Sums wrap round, as on the device.
    const auto add = [](unsigned a, unsigned b) { return a + b; };
    return static_cast<T>(
        cuda_on_cpu::reduce({"__reduce_add_sync", file, line}, mask, static_cast<unsigned>(value), add));
}
template <cuda_on_cpu::Reducible T>
T __reduce_min_sync(unsigned mask, T value, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
    return cuda_on_cpu::reduce({"__reduce_min_sync", file, line}, mask, value, [](T a, T b) { return b < a ? b : a; });
}
template <cuda_on_cpu::Reducible T>
T __reduce_max_sync(unsigned mask, T value, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
    return cuda_on_cpu::reduce({"__reduce_max_sync", file, line}, mask, value, [](T a, T b) { return a < b ? b : a; });
}
inline unsigned __reduce_and_sync(unsigned mask, unsigned value, const char* file = __builtin_FILE(),
                                  int line = __builtin_LINE()) {
    return cuda_on_cpu::reduce({"__reduce_and_sync", file, line}, mask, value,
                               [](unsigned a, unsigned b) { return a & b; });
}
inline unsigned __reduce_or_sync(unsigned mask, unsigned value, const char* file = __builtin_FILE(),
                                 int line = __builtin_LINE()) {
    return cuda_on_cpu::reduce({"__reduce_or_sync", file, line}, mask, value,
                               [](unsigned a, unsigned b) { return a | b; });
}
inline unsigned __reduce_xor_sync(unsigned mask, unsigned value, const char* file = __builtin_FILE(),
                                  int line = __builtin_LINE()) {
    return cuda_on_cpu::reduce({"__reduce_xor_sync", file, line}, mask, value,
                               [](unsigned a, unsigned b) { return a ^ b; });
}
