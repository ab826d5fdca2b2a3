#pragma once

#include <cstdint>

#include "cuda_on_cpu/machine/block.h"
#include "cuda_on_cpu/machine/report.h"

namespace cuda_on_cpu {

/// Returns the block's dynamic shared memory as a T. An error if the launch has fewer bytes of it.
template <class T>
T& dynamic_shared() {
    static_assert(alignof(T) <= 16, "dynamic shared memory is aligned to 16 bytes, not more");
    const Block& block = Block::current();
    if (block.shared_bytes() < sizeof(T))
        fail_in_kernel("requests %zu bytes of dynamic shared memory, but the launch has %zu", sizeof(T),
                       block.shared_bytes());
    return *reinterpret_cast<T*>(block.shared());
}

}  // namespace cuda_on_cpu
