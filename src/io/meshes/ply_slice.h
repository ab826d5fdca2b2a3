#pragma once

// Slices of binary PLY.

#include <optional>

#include "io/bytes/row_file.h"
#include "io/bytes/slice.h"
#include "io/bytes/source.h"

namespace crumple::io {

/// Reads a slice of a PLY file as read_slice() does (io/bytes/slice.h). `beginning`: first bytes of the file, including
/// its header.
std::optional<MeshSlice> read_ply_slice(RowFile& file, const Source& beginning, const ReadOptions& options, int reader,
                                        int readers);

}  // namespace crumple::io
