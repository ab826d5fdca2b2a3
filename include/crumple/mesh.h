#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "crumple/error.h"
#include "crumple/features.h"

// Lets Clang and MSVC warn about a view that outlives the temporary array it was made from.
#if defined(__has_cpp_attribute)
#if __has_cpp_attribute(clang::lifetimebound)
#define CRUMPLE_LIFETIMEBOUND [[clang::lifetimebound]]
#elif __has_cpp_attribute(msvc::lifetimebound)
#define CRUMPLE_LIFETIMEBOUND [[msvc::lifetimebound]]
#endif
#endif
#ifndef CRUMPLE_LIFETIMEBOUND
#define CRUMPLE_LIFETIMEBOUND
#endif

namespace crumple {

/// Type of coordinates.
enum class ScalarType : std::uint8_t { float32, float64 };
/// Type of the indices of triangles.
enum class IndexType : std::uint8_t { int32, uint32, int64 };
/// Memory that holds the arrays of a mesh. `cuda`: memory that the CUDA device of the detector can read.
enum class MemorySpace : std::uint8_t { host, cuda };

/// View of a (rows, 3) array that the caller owns. Strides are in bytes, so row-major, column-major and interleaved
/// layouts need no copy. A view with rows must state both strides.
template <class Type>
struct ArrayView {
    static constexpr std::int64_t no_stride = std::numeric_limits<std::int64_t>::min();

    const void* data = nullptr;
    std::int64_t rows = 0;
    std::int64_t row_stride = no_stride;     ///< bytes from row i to row i + 1
    std::int64_t column_stride = no_stride;  ///< bytes from x to y to z
    Type type{};
    friend bool operator==(const ArrayView&, const ArrayView&) = default;
};

/// View of coordinates, one vertex per row.
using VertexView = ArrayView<ScalarType>;
/// View of vertex indices, one triangle per row.
using TriangleView = ArrayView<IndexType>;

/// Matrix in memory with strides counted in elements: Eigen's Matrix, Map, Ref and blocks, row- or column-major.
template <class Matrix>
concept MatrixInMemory = requires(const Matrix& m) {
    *m.data();
    { m.rows() } -> std::convertible_to<std::int64_t>;
    { m.cols() } -> std::convertible_to<std::int64_t>;
    { m.rowStride() } -> std::convertible_to<std::int64_t>;
    { m.colStride() } -> std::convertible_to<std::int64_t>;
};

/// View of a triangle soup that the caller owns; nothing is copied. Works on any triangle soup: open, non-manifold,
/// with duplicated or degenerate triangles, several objects in one array.
///
/// The arrays must stay unchanged until the call that was given the view returns.
struct MeshView {
    VertexView vertices;                   ///< (n, 3) coordinates
    TriangleView triangles;                ///< (m, 3) indices into `vertices`
    std::span<const std::int32_t> groups;  ///< one id per triangle, or empty: all in group 0
    MemorySpace memory = MemorySpace::host;
    void* stream = nullptr;  ///< CUDA stream on which device arrays become ready

    /// Positions of the vertices at the end of a step, for queries about motion: (n, 3), in the same memory as
    /// `vertices`. Queries about one time use the start. Without data, nothing moves.
    VertexView end = {};
    /// Returns this mesh with the given positions at the end of the step.
    MeshView moving_to(const VertexView& end) const {
        MeshView moving = *this;
        moving.end = end;
        return moving;
    }

    /// Edges and points for queries about motion and nearness. If set, they replace the default features: the
    /// triangles' edges, and the vertices that a triangle or an edge names. Use them for rods, hair and particles, or
    /// if the mesh comes with such lists. The project calls them codimensional edges and points, although a triangle
    /// may name them, too. Results name an edge or a point by its position in the list; an entry that is listed twice
    /// is reported twice. The ends of an edge must differ. Queries about intersections ignore both lists.
    std::optional<std::span<const Edge>> edges = {};
    std::optional<std::span<const std::int32_t>> points = {};

    /// Makes a view of an empty mesh.
    MeshView() = default;
    /// Views arrays of any layout, in host memory unless `memory` is set.
    MeshView(VertexView vertices, TriangleView triangles, std::span<const std::int32_t> groups = {})
        : vertices(vertices), triangles(triangles), groups(groups) {}

    /// Views contiguous rows of three: float or double coordinates, and int32_t, uint32_t or int64_t indices.
    template <class Scalar, class Index>
    MeshView(const Scalar* xyz, std::int64_t vertex_count, const Index* ijk, std::int64_t triangle_count,
             std::span<const std::int32_t> groups = {});

    /// Views vectors of rows.
    template <class Scalar, class Index>
    MeshView(const std::vector<std::array<Scalar, 3>>& vertices CRUMPLE_LIFETIMEBOUND,
             const std::vector<std::array<Index, 3>>& triangles CRUMPLE_LIFETIMEBOUND,
             std::span<const std::int32_t> groups = {})
        : MeshView(vertices.empty() ? nullptr : vertices[0].data(), static_cast<std::int64_t>(vertices.size()),
                   triangles.empty() ? nullptr : triangles[0].data(), static_cast<std::int64_t>(triangles.size()),
                   groups) {}

    /// Views matrices of three columns, such as Eigen's, in either storage order. Throws Error (invalid_argument) for
    /// another number of columns.
    template <MatrixInMemory Vertices, MatrixInMemory Triangles>
    MeshView(const Vertices& vertices CRUMPLE_LIFETIMEBOUND, const Triangles& triangles CRUMPLE_LIFETIMEBOUND,
             std::span<const std::int32_t> groups = {});
};

namespace detail {
template <class T>
constexpr auto type_of() {
    using Number = std::remove_cv_t<T>;
    constexpr bool scalar = std::is_same_v<Number, float> || std::is_same_v<Number, double>;
    constexpr bool index = std::is_integral_v<Number> && !std::is_same_v<Number, bool> &&
                           (sizeof(T) == 4 || (sizeof(T) == 8 && std::is_signed_v<Number>));
    static_assert(scalar || index, "coordinates must be float or double; indices must be int32_t, uint32_t or int64_t");
    if constexpr (std::is_same_v<Number, float>)
        return ScalarType::float32;
    else if constexpr (scalar)
        return ScalarType::float64;
    else if constexpr (sizeof(T) == 8)
        return IndexType::int64;
    else
        return std::is_signed_v<Number> ? IndexType::int32 : IndexType::uint32;
}

template <class T>
constexpr void check_scalar() {
    static_assert(std::is_floating_point_v<T>, "vertices come first, as float or double; then the triangles' indices");
}
template <class T>
constexpr void check_index() {
    static_assert(std::is_integral_v<T>, "triangles must be indices of type int32_t, uint32_t or int64_t");
}
}  // namespace detail

/// Returns a view of `rows` contiguous rows of three values.
template <class T>
auto rows_of_three(const T* data, std::int64_t rows) {
    constexpr auto type = detail::type_of<T>();
    return ArrayView<std::remove_const_t<decltype(type)>>{data, rows, 3 * sizeof(T), sizeof(T), type};
}

/// Returns a view of a matrix of three columns, without a copy. Throws Error (invalid_argument) for another number of
/// columns; the message calls the matrix `what`.
template <MatrixInMemory Matrix>
auto rows_of(const Matrix& matrix CRUMPLE_LIFETIMEBOUND, const char* what) {
    if (matrix.cols() != 3)
        throw Error(ErrorCode::invalid_argument, std::string(what) + " must have one row each and 3 columns, not " +
                                                     std::to_string(matrix.cols()) + " columns");
    auto view = rows_of_three(matrix.data(), matrix.rows());
    constexpr std::int64_t size = sizeof *matrix.data();
    view.row_stride = size * static_cast<std::int64_t>(matrix.rowStride());
    view.column_stride = size * static_cast<std::int64_t>(matrix.colStride());
    return view;
}

template <class Scalar, class Index>
MeshView::MeshView(const Scalar* xyz, std::int64_t vertex_count, const Index* ijk, std::int64_t triangle_count,
                   std::span<const std::int32_t> groups)
    : groups(groups) {
    detail::check_scalar<Scalar>();
    detail::check_index<Index>();
    if constexpr (std::is_floating_point_v<Scalar> && std::is_integral_v<Index>) {
        vertices = rows_of_three(xyz, vertex_count);
        triangles = rows_of_three(ijk, triangle_count);
    }
}

template <MatrixInMemory Vertices, MatrixInMemory Triangles>
MeshView::MeshView(const Vertices& v CRUMPLE_LIFETIMEBOUND, const Triangles& t CRUMPLE_LIFETIMEBOUND,
                   std::span<const std::int32_t> groups)
    : groups(groups) {
    using Scalar = std::remove_cvref_t<decltype(*v.data())>;
    using Index = std::remove_cvref_t<decltype(*t.data())>;
    detail::check_scalar<Scalar>();
    detail::check_index<Index>();
    if constexpr (std::is_floating_point_v<Scalar> && std::is_integral_v<Index>) {
        vertices = rows_of(v, "vertices");
        triangles = rows_of(t, "triangles");
    }
}

}  // namespace crumple
