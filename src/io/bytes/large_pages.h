#pragma once

// Large memory pages, where the system has them: a large new block then costs a page fault for each 2 MiB, not for each
// 4 KiB. The faults for 4 KiB pages would take longer than reading a file into the block.

#include <cstddef>
#include <cstdint>
#include <vector>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace crumple::io {

/// Requests large pages for memory that has not been written yet. The system may ignore the request.
inline void advise_large_pages([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t bytes) {
#ifdef MADV_HUGEPAGE
    constexpr std::size_t page = std::size_t{1} << 21;
    const std::size_t skipped = (page - reinterpret_cast<std::uintptr_t>(memory) % page) % page;
    if (bytes >= skipped + page)
        madvise(static_cast<char*>(memory) + skipped, (bytes - skipped) / page * page, MADV_HUGEPAGE);
#endif
}

template <class T>
void reserve_large(std::vector<T>& vector, std::size_t size) {
    vector.reserve(size);
    advise_large_pages(vector.data(), vector.capacity() * sizeof(T));
}

}  // namespace crumple::io
