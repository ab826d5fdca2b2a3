#pragma once

// Binary file that several readers share: each reads its own rows. Blocks of rows follow each other, reader by reader.

#include <cstdint>
#include <filesystem>
#include <optional>

#include "crumple/io.h"

namespace crumple::io {

/// Rows in as many blocks as there are readers.
struct Blocks {
    std::int64_t rows = 0;
    int readers = 1;
    int together = 1;  ///< rows that no two blocks share, such as the vertices of a triangle

    std::int64_t begin(int reader) const { return rows / together * reader / readers * together; }
    std::int64_t end(int reader) const { return begin(reader + 1); }
    std::int64_t size(int reader) const { return end(reader) - begin(reader); }
    /// Returns whose block a row lies in.
    int reader_of(std::int64_t row) const {
        return static_cast<int>(((row / together + 1) * readers - 1) / (rows / together));
    }
};

/// One reader's part of a mesh.
struct MeshSlice {
    Blocks triangles, vertices;  ///< of the whole file
    /// A block of triangles and a block of vertices, and the groups of the triangles. Corners are numbers over the
    /// whole file, so that they may name vertices of other blocks.
    TriangleMesh mesh;
    bool weld = false;  ///< vertices at equal positions, of any reader, are one
};

/// Reads the block of one of several readers. The blocks of all are what read_mesh would read, but for welding, which
/// is left to the one who searches. Nothing for a file whose rows have no places that follow from the header, or that
/// is odd in any way: read_mesh knows what to make of it. That is, it reads binary PLY of triangles and binary STL.
/// Another reader sees what this one cannot see in its own block, such as a polygon.
///
/// Throws Error (file, format) as read_mesh does, for what is wrong in this block. Reads its rows in pieces.
std::optional<MeshSlice> read_slice(const std::filesystem::path& path, const ReadOptions& options, int reader,
                                    int readers);

}  // namespace crumple::io
