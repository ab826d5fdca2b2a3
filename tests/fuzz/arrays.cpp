#include <cstring>

#include "fuzz/decode.h"

namespace crumple::fuzz {
namespace {

template <class Value>
void put(std::byte* at, Value value) {
    std::memcpy(at, &value, sizeof value);
}

/// Stores rows of three values of `size` bytes in one of six arrangements: contiguous, by column, in records, with rows
/// reversed, unaligned, or with columns reversed. Calls store(row, column, at) to write each value at an address, and
/// sets the address and the strides of `view`.
template <class View, class Store>
void place_arrays(std::vector<std::byte>& block, View& view, int arrangement, std::int64_t rows, std::int64_t size,
                  Store store) {
    std::int64_t row = 3 * size, column = size, begin = 0, bytes = 3 * size * rows;
    switch (arrangement) {
        case 1:
            row = size, column = rows * size;
            break;
        case 2:
            row = 5 * size, bytes = rows > 0 ? 5 * size * (rows - 1) + 3 * size : 0;
            break;
        case 3:
            row = -3 * size, begin = rows > 0 ? 3 * size * (rows - 1) : 0;
            break;
        case 4:
            row = 3 * size + 1, begin = 1, bytes = rows > 0 ? 1 + (3 * size + 1) * (rows - 1) + 3 * size : 1;
            break;
        case 5:
            column = -size, begin = 2 * size;
            break;
        default:
            break;
    }
    block.resize(static_cast<std::size_t>(bytes));
    for (std::int64_t r = 0; r < rows; ++r)
        for (std::int64_t c = 0; c < 3; ++c) store(r, c, block.data() + begin + r * row + c * column);
    view.data = rows > 0 ? block.data() + begin : nullptr;
    view.rows = rows;
    view.row_stride = row;
    view.column_stride = column;
}

}  // namespace

Arrays::Arrays(const Mesh& mesh) : groups_(mesh.groups) {
    view_.vertices.type = mesh.single ? ScalarType::float32 : ScalarType::float64;
    place_arrays(vertices_, view_.vertices, mesh.layout.vertices, static_cast<std::int64_t>(mesh.vertices.size()),
                 mesh.single ? 4 : 8, [&](std::int64_t r, std::int64_t c, std::byte* at) {
                     const double x = mesh.vertices[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)];
                     if (mesh.single)
                         put(at, static_cast<float>(x));
                     else
                         put(at, x);
                 });
    view_.triangles.type = mesh.layout.index;
    place_arrays(triangles_, view_.triangles, mesh.layout.triangles, static_cast<std::int64_t>(mesh.triangles.size()),
                 mesh.layout.index == IndexType::int64 ? 8 : 4, [&](std::int64_t r, std::int64_t c, std::byte* at) {
                     const std::int64_t i = mesh.triangles[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)];
                     if (mesh.layout.index == IndexType::int64)
                         put(at, i);
                     else
                         put(at, static_cast<std::int32_t>(i));
                 });
    view_.groups = groups_;
}

}  // namespace crumple::fuzz
