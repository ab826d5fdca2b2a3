#pragma once

#include <cuda_runtime.h>

namespace cub {

struct NullType {};

/// Two buffers of the same size, one of which holds the data. A sort may swap them.
template <class T>
struct DoubleBuffer {
    T* d_buffers[2] = {nullptr, nullptr};
    int selector = 0;

    DoubleBuffer() = default;
    DoubleBuffer(T* current, T* alternate) : d_buffers{current, alternate} {}
    T* Current() { return d_buffers[selector]; }
    T* Alternate() { return d_buffers[selector ^ 1]; }
};

}  // namespace cub
