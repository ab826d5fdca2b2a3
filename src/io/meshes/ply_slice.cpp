// Reads slices of binary PLY files in which all rows of an element have one length: the only lists are the corners of
// faces, three per face. Each reader checks this for the faces of its block. A face with another number of corners
// would shift all rows behind it, so read_ply_slice() then returns nothing.

#include "io/meshes/ply_slice.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string>
#include <type_traits>
#include <vector>

#include "io/bytes/bytes.h"
#include "io/formats.h"
#include "io/meshes/ply_header.h"

namespace crumple::io {
namespace {

std::int64_t size_of(PlyType type) {
    return with_type(type, [](auto zero) { return static_cast<std::int64_t>(sizeof zero); });
}

template <class Value>
Value value_at(const char* p, PlyType type, std::endian order) {
    return with_type(type, [&](auto zero) { return static_cast<Value>(load<decltype(zero)>(p, order)); });
}

// Numbers by which Column identifies the properties that are read; 0, 1 and 2 are x, y and z.
constexpr std::size_t corners_number = 3, group_number = 4, property_count = 5;

struct Column {
    std::size_t number;
    std::int64_t place;  ///< byte offset in the row
    const PlyProperty* property;
};

/// Place and layout of the rows of an element, in bytes of the file.
struct Rows {
    std::int64_t count = 0, begin = 0, row_bytes = 0;
    std::vector<Column> columns;  ///< properties that are read, in the order of the row
};

struct Layout {
    std::endian byte_order;
    ScalarType precision;
    Rows vertices, faces;
};

/// Returns where the rows of vertices and faces lie. Returns nothing if the file is text, has no faces or has triangle
/// strips, if a property that is read is missing or has an unsuitable type, if rows have no fixed length, or if their
/// total length is not that of the file. Throws Error if the header names an element or a property twice.
std::optional<Layout> layout_of(const RowFile& file, const Source& beginning, const PlyHeader& header,
                                const std::string& group_property) {
    const PlyElement* const vertex = header.find(beginning, "vertex");
    const PlyElement* const face = header.find(beginning, "face");
    if (header.encoding == PlyEncoding::ascii || !vertex || !face || face->count == 0) return std::nullopt;
    if (header.find(beginning, "tristrips")) return std::nullopt;
    const std::array<const PlyProperty*, property_count> wanted{
        vertex->find(beginning, {"x"}), vertex->find(beginning, {"y"}), vertex->find(beginning, {"z"}),
        face->find(beginning, {"vertex_indices", "vertex_index"}), face->find(beginning, {group_property})};
    Layout layout{header.encoding == PlyEncoding::big_endian ? std::endian::big : std::endian::little,
                  ScalarType::float32,
                  {},
                  {}};
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        if (i == group_number && group_property.empty()) continue;
        if (!wanted[i] || (i >= corners_number && !is_integer(wanted[i]->type))) return std::nullopt;
        if (i < corners_number && wanted[i]->type != PlyType::float32) layout.precision = ScalarType::float64;
    }
    std::int64_t begin = header.body - beginning.begin();
    for (const PlyElement& element : header.elements) {
        Rows rows{element.count, begin, 0, {}};
        for (const PlyProperty& property : element.properties) {
            const auto found =
                static_cast<std::size_t>(std::find(wanted.begin(), wanted.end(), &property) - wanted.begin());
            if (property.count_type.has_value() != (found == corners_number)) return std::nullopt;
            if (found < property_count) rows.columns.push_back({found, rows.row_bytes, &property});
            const std::int64_t bytes = size_of(property.type);
            rows.row_bytes += property.count_type ? size_of(*property.count_type) + 3 * bytes : bytes;
        }
        if (rows.row_bytes > 0 && rows.count > (file.size() - begin) / rows.row_bytes) return std::nullopt;
        begin += rows.count * rows.row_bytes;
        if (&element == vertex) layout.vertices = rows;
        if (&element == face) layout.faces = rows;
    }
    return begin == file.size() ? std::optional(layout) : std::nullopt;
}

/// Calls f(row, byte offset of the row) for each row of a reader's block, until f returns false. Returns false if it
/// did.
template <class F>
bool for_each_row(RowFile& file, const Rows& rows, const Blocks& blocks, int reader, F f) {
    return file.for_each(rows.begin + blocks.begin(reader) * rows.row_bytes, rows.row_bytes, blocks.size(reader), f);
}

template <class Scalar>
std::vector<Scalar> read_vertices(RowFile& file, const Layout& layout, const Blocks& blocks, int reader) {
    std::vector<Scalar> xyz(3 * static_cast<std::size_t>(blocks.size(reader)));
    Scalar* vertex = xyz.data();
    for_each_row(file, layout.vertices, blocks, reader, [&](const char* row, std::int64_t byte) {
        for (const auto& [axis, place, property] : layout.vertices.columns) {
            vertex[axis] = value_at<Scalar>(row + place, property->type, layout.byte_order);
            if (!std::isfinite(vertex[axis]))
                file.fail_at(byte + place, std::is_same_v<Scalar, float> ? "a coordinate is not a finite float32"
                                                                         : "a coordinate is not finite");
        }
        vertex += 3;
        return true;
    });
    return xyz;
}

/// Reads the faces of a reader's block. Returns false at a face that does not have three corners.
bool read_faces(RowFile& file, const Layout& layout, int reader, MeshSlice& slice) {
    const auto read_corners = [&](const char* row, std::int64_t byte, const Column& column) {
        const PlyProperty& list = *column.property;
        const std::int64_t step = size_of(list.type), first = column.place + size_of(*list.count_type);
        if (value_at<std::int64_t>(row + column.place, *list.count_type, layout.byte_order) != 3) return false;
        for (std::int64_t at = first; at < first + 3 * step; at += step) {
            const auto index = value_at<std::int64_t>(row + at, list.type, layout.byte_order);
            if (index < 0 || index >= slice.vertices.rows)
                file.fail_at(byte + at, "a face names vertex " + std::to_string(index) + " of " +
                                            std::to_string(slice.vertices.rows));
            slice.mesh.triangles.push_back(static_cast<std::int32_t>(index));
        }
        return true;
    };
    return for_each_row(file, layout.faces, slice.triangles, reader, [&](const char* row, std::int64_t byte) {
        for (const Column& column : layout.faces.columns) {
            if (column.number == corners_number && !read_corners(row, byte, column)) return false;
            if (column.number != group_number) continue;
            const auto value = value_at<std::int64_t>(row + column.place, column.property->type, layout.byte_order);
            if (value != static_cast<std::int32_t>(value))
                file.fail_at(byte + column.place, "a group does not fit in 32 bits");
            slice.mesh.groups.push_back(static_cast<std::int32_t>(value));
        }
        return true;
    });
}

}  // namespace

std::optional<MeshSlice> read_ply_slice(RowFile& file, const Source& beginning, const ReadOptions& options, int reader,
                                        int readers) {
    PlyHeader header;
    std::optional<Layout> layout;
    try {
        header = read_ply_header(beginning);
        layout = layout_of(file, beginning, header, options.group_property);
    } catch (const Error&) {  // the caller uses read_mesh() instead, which reports the error
    }
    if (!layout) return std::nullopt;
    MeshSlice slice{{layout->faces.count, readers}, {layout->vertices.count, readers}, {}, options.weld == Weld::yes};
    if (std::max(slice.triangles.rows, slice.vertices.rows) > INT32_MAX)
        throw Error(ErrorCode::format, file.name() + ": it has more vertices or triangles than 32-bit ids can number");
    slice.mesh = in_precision(options.precision, layout->precision, [&](auto zero) {
        return TriangleMesh{read_vertices<decltype(zero)>(file, *layout, slice.vertices, reader), {}};
    });
    slice.mesh.triangles.reserve(3 * static_cast<std::size_t>(slice.triangles.size(reader)));
    if (!read_faces(file, *layout, reader, slice)) return std::nullopt;
    return slice;
}

}  // namespace crumple::io
