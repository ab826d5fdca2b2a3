#pragma once

// Reads a mesh's indices from the caller's memory, in any type and with any strides.

#include <cstdint>
#include <cstring>

#include "backends/cuda/device/runtime.h"
#include "scene/outline.h"

namespace crumple::cuda {

/// Reader of indices; byte by byte if they are not aligned, because a device loads aligned values only.
template <class Index, bool aligned>
struct IndexReader {
    const std::byte* data;
    std::int64_t row_stride, column_stride;

    explicit IndexReader(const TriangleView& view)
        : data(static_cast<const std::byte*>(view.data)),
          row_stride(view.row_stride),
          column_stride(view.column_stride) {}
    __device__ std::int64_t operator()(std::size_t t, int corner) const {
        const std::byte* place = data + static_cast<std::int64_t>(t) * row_stride + corner * column_stride;
        if constexpr (aligned) return static_cast<std::int64_t>(*reinterpret_cast<const Index*>(place));
        Index value;
        std::memcpy(&value, place, sizeof value);
        return static_cast<std::int64_t>(value);
    }
};

/// Calls work(reader) with the reader for the view.
template <class Work>
void with_reader(const TriangleView& view, Work work) {
    with_index_type(view.type, [&](auto index) {
        using Index = decltype(index);
        const auto places = reinterpret_cast<std::uintptr_t>(view.data) |
                            static_cast<std::uintptr_t>(view.row_stride | view.column_stride);
        if (places % alignof(Index) == 0)
            work(IndexReader<Index, true>(view));
        else
            work(IndexReader<Index, false>(view));
    });
}

}  // namespace crumple::cuda
