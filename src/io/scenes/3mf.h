#pragma once

#include <string>

#include "crumple/io.h"
#include "io/bytes/source.h"

namespace crumple::io {

/// Reads the bodies that the build of a 3MF file places. Several bodies may have the same name. Throws Error (format).
WorldMesh read_3mf(const Source& source, const ReadOptions& options, Warnings& warnings);

/// True if a file is 3MF by its content (a zip archive) or by its extension (lower case, with its dot).
bool is_3mf(const Source& source, const std::string& extension);

}  // namespace crumple::io
