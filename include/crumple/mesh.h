#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "crumple/features.h"

namespace crumple {

enum class ScalarType : std::uint8_t { float32, float64 };
enum class IndexType : std::uint8_t { int32, uint32, int64 };
enum class MemorySpace : std::uint8_t { host, cuda };

/// A (rows, 3) array that somebody else owns. Strides are in bytes, so that row-major, column-major and
/// interleaved layouts are read where they lie.
template <class Type>
struct ArrayView {
    const void* data = nullptr;
    std::int64_t rows = 0;
    std::int64_t row_stride = 0;     ///< bytes from row i to row i + 1
    std::int64_t column_stride = 0;  ///< bytes from x to y to z
    Type type{};
    friend bool operator==(const ArrayView&, const ArrayView&) = default;
};

using VertexView = ArrayView<ScalarType>;
using TriangleView = ArrayView<IndexType>;

/// A triangle soup that somebody else owns; nothing is copied. Any soup will do: open, non-manifold, with
/// duplicated or degenerate triangles, several objects in one array.
///
/// The arrays must stay as they are until the call that was given the view returns.
struct MeshView {
    VertexView vertices;                   ///< (n, 3) coordinates
    TriangleView triangles;                ///< (m, 3) indices into `vertices`
    std::span<const std::int32_t> groups;  ///< one id a triangle, or empty: all in group 0
    MemorySpace memory = MemorySpace::host;
    void* stream = nullptr;  ///< CUDA stream on which device arrays become ready

    /// What is meant by edges and by points where motion and nearness are asked about, instead of the triangles' edges
    /// and the vertices that a triangle or an edge names: rods, hair, particles, or a mesh's own lists. Answers name
    /// them by their place in the list; what is listed twice is answered twice. An edge has two different vertices.
    /// Questions about intersections do not read them.
    std::optional<std::span<const Edge>> edges = {};
    std::optional<std::span<const std::int32_t>> points = {};

    MeshView() = default;
    MeshView(VertexView vertices, TriangleView triangles, std::span<const std::int32_t> groups = {})
        : vertices(vertices), triangles(triangles), groups(groups) {}

    /// Row-major, contiguous arrays: 3n scalars and 3m indices.
    template <class Scalar, class Index>
    MeshView(const Scalar* xyz, std::int64_t vertex_count, const Index* ijk, std::int64_t triangle_count,
             std::span<const std::int32_t> groups = {});

    template <class Scalar, class Index>
    MeshView(const std::vector<std::array<Scalar, 3>>& vertices, const std::vector<std::array<Index, 3>>& triangles,
             std::span<const std::int32_t> groups = {})
        : MeshView(vertices.empty() ? nullptr : vertices[0].data(), static_cast<std::int64_t>(vertices.size()),
                   triangles.empty() ? nullptr : triangles[0].data(), static_cast<std::int64_t>(triangles.size()),
                   groups) {}
};

namespace detail {
constexpr ScalarType type_of(float) { return ScalarType::float32; }
constexpr ScalarType type_of(double) { return ScalarType::float64; }
constexpr IndexType type_of(std::int32_t) { return IndexType::int32; }
constexpr IndexType type_of(std::uint32_t) { return IndexType::uint32; }
constexpr IndexType type_of(std::int64_t) { return IndexType::int64; }
}  // namespace detail

/// View of `rows` contiguous rows of three values.
template <class T>
auto rows_of_three(const T* data, std::int64_t rows) {
    return ArrayView<decltype(detail::type_of(T{}))>{data, rows, 3 * sizeof(T), sizeof(T), detail::type_of(T{})};
}

template <class Scalar, class Index>
MeshView::MeshView(const Scalar* xyz, std::int64_t vertex_count, const Index* ijk, std::int64_t triangle_count,
                   std::span<const std::int32_t> groups)
    : vertices(rows_of_three(xyz, vertex_count)), triangles(rows_of_three(ijk, triangle_count)), groups(groups) {}

}  // namespace crumple
