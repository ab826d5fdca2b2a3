#pragma once

// Normalised vertices for the stages after `bounds`: rows of four numbers, the last of which is 0. Compiled for host
// and device.

#include <cstdint>

#include "geometry/vec.h"

namespace crumple {

/// Row of normalised coordinates, aligned so that a device loads it as a whole.
template <class T>
struct alignas(4 * sizeof(T)) Row {
    T x, y, z, unused;
};

/// Rows in float32 if that represents all coordinates exactly, otherwise in float64; the other pointer is null.
struct PointRows {
    const float* f = nullptr;  ///< on a device, both pointers are aligned as a Row
    const double* d = nullptr;

    /// Returns a vertex, exactly.
    CRUMPLE_HD Vec3d operator[](std::int32_t vertex) const {
        if (f) {
            const Vec3f p = in_float(vertex);
            return {p.x, p.y, p.z};
        }
        return row(d, vertex);
    }
    /// Returns a vertex from float32 rows, which must exist.
    CRUMPLE_HD Vec3f in_float(std::int32_t vertex) const { return row(f, vertex); }

    /// Prefetches the row of a vertex.
    void prefetch(std::int32_t vertex) const {
        const std::int64_t i = 4 * static_cast<std::int64_t>(vertex);
        __builtin_prefetch(f ? static_cast<const void*>(f + i) : d + i);
    }

   private:
    /// Reads a row. A device loads it as a whole, so rows must be aligned as a Row there.
    template <class T>
    static CRUMPLE_HD Vec3<T> row(const T* rows, std::int32_t vertex) {
#ifdef __CUDA_ARCH__
        const Row<T> whole = reinterpret_cast<const Row<T>*>(rows)[vertex];
        return {whole.x, whole.y, whole.z};
#else
        const T* const p = rows + 4 * static_cast<std::int64_t>(vertex);
        return {p[0], p[1], p[2]};
#endif
    }
};

}  // namespace crumple
