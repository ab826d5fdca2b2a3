#pragma once

// The normalised vertices, as stages after `bounds` read them: rows of four, the last element 0. Compiled for host and
// device.

#include <cstdint>

#include "geometry/vec.h"

namespace crumple {

/// A row of normalised coordinates, exact in the scene's precision: one load on a device.
template <class T>
struct alignas(4 * sizeof(T)) Row {
    T x, y, z, unused;
};

/// float32 rows where those are exact, else float64 ones: one pointer is null.
struct PointRows {
    const float* f = nullptr;  ///< on a device at the place of a Row
    const double* d = nullptr;

    /// A vertex, without loss.
    CRUMPLE_HD Vec3d operator[](std::int32_t vertex) const {
        if (f) {
            const Vec3f p = in_float(vertex);
            return {p.x, p.y, p.z};
        }
        return row(d, vertex);
    }
    /// The same where rows are of float32.
    CRUMPLE_HD Vec3f in_float(std::int32_t vertex) const { return row(f, vertex); }

    /// Of a vertex that is wanted soon.
    void prefetch(std::int32_t vertex) const {
        const std::int64_t i = 4 * static_cast<std::int64_t>(vertex);
        __builtin_prefetch(f ? static_cast<const void*>(f + i) : d + i);
    }

   private:
    /// On a device in one load, for which rows have to be aligned there.
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
