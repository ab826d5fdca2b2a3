#pragma once

#include <string>

#include "crumple/io.h"
#include "io/bytes/source.h"

namespace crumple::io {

/// What the build of a 3MF file puts where. Names may repeat.
WorldMesh read_3mf(const Source& source, const ReadOptions& options, Warnings& warnings);

/// Whether a file is 3MF, by its content, or by its extension (lower case, with its dot).
bool is_3mf(const Source& source, const std::string& extension);

}  // namespace crumple::io
