#pragma once

// Slices of binary PLY.

#include <optional>

#include "io/row_file.h"
#include "io/slice.h"
#include "io/source.h"

namespace crumple::io {

/// Reads as read_slice does. `beginning`: bytes of the file that hold its header.
std::optional<MeshSlice> read_ply_slice(const RowFile& file, const Source& beginning, const ReadOptions& options,
                                        int reader, int readers);

}  // namespace crumple::io
