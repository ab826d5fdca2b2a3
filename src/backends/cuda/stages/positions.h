#pragma once

// Reads the caller's vertices in kernels: number by number if they are aligned, else byte by byte.

#include <cstdint>

#include "backends/cuda/device/runtime.h"
#include "scene/prepared_scene.h"

namespace crumple::cuda {

template <class T>
bool is_aligned(const VertexReader& reader) {
    return (reinterpret_cast<std::uintptr_t>(reader.data) | static_cast<std::uintptr_t>(reader.row_stride) |
            static_cast<std::uintptr_t>(reader.column_stride)) %
               alignof(T) ==
           0;
}
inline bool is_aligned(const VertexReader& reader) {
    return reader.float32 ? is_aligned<float>(reader) : is_aligned<double>(reader);
}
inline bool is_aligned(const PreparedScene& scene) {
    return is_aligned(scene.reader[0]) && is_aligned(scene.reader[1]) && (!scene.moving || is_aligned(scene.end));
}

namespace detail {

template <class T>
CRUMPLE_HD Vec3d read(const VertexReader& reader, std::size_t v) {
    const std::byte* row = reader.data + static_cast<std::int64_t>(v) * reader.row_stride;
    const auto scalar = [&](int axis) {
        return static_cast<double>(*reinterpret_cast<const T*>(row + axis * reader.column_stride));
    };
    return {scalar(0), scalar(1), scalar(2)};
}
template <bool aligned>
CRUMPLE_HD Vec3d read(const VertexReader& reader, std::size_t v) {
    if constexpr (!aligned) return reader(static_cast<std::int64_t>(v));
    return reader.float32 ? read<float>(reader, v) : read<double>(reader, v);
}

}  // namespace detail

template <bool aligned>
CRUMPLE_HD Vec3d position(const PreparedScene& scene, std::size_t v) {
    const auto first = static_cast<std::size_t>(scene.vertices[0]);
    return v < first ? detail::read<aligned>(scene.reader[0], v) : detail::read<aligned>(scene.reader[1], v - first);
}
template <bool aligned>
CRUMPLE_HD Vec3d end_position(const PreparedScene& scene, std::size_t v) {
    return detail::read<aligned>(scene.end, v);
}

}  // namespace crumple::cuda
