#pragma once

// Slices of a binary file that several readers share: each reads its own block of rows. Blocks are consecutive, in the
// order of the readers.

#include <cstdint>
#include <filesystem>
#include <optional>

#include "crumple/io.h"

namespace crumple::io {

/// Division of rows into one block per reader.
struct Blocks {
    std::int64_t rows = 0;
    int readers = 1;
    int together = 1;  ///< successive rows that must share a block: 3 for the vertices of a triangle

    std::int64_t begin(int reader) const { return rows / together * reader / readers * together; }
    std::int64_t end(int reader) const { return begin(reader + 1); }
    std::int64_t size(int reader) const { return end(reader) - begin(reader); }
    /// Returns the reader whose block holds a row.
    int reader_of(std::int64_t row) const {
        return static_cast<int>(((row / together + 1) * readers - 1) / (rows / together));
    }
};

/// One reader's part of a mesh.
struct MeshSlice {
    Blocks triangles, vertices;  ///< division of all triangles and all vertices of the file among the readers
    /// The reader's block of triangles, with their groups, and its block of vertices. Corners are vertex indices of the
    /// whole file, so they may refer to other blocks.
    TriangleMesh mesh;
    bool weld = false;  ///< vertices at equal positions must be merged later, across the blocks of all readers
};

/// Reads the block of one of several readers. All blocks together are what read_mesh reads, except that vertices are
/// not welded (MeshSlice::weld). Handles binary PLY of triangles and binary STL. Returns nothing for any other file,
/// and for any irregularity in the header or in this block, such as a polygon; use read_mesh then. Only the reader of a
/// block finds the irregularities in it.
///
/// Throws Error (file, format) as read_mesh does, for errors in this block. Reads rows in pieces of some 4 MiB.
std::optional<MeshSlice> read_slice(const std::filesystem::path& path, const ReadOptions& options, int reader,
                                    int readers);

}  // namespace crumple::io
