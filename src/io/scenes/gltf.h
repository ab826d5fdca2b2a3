#pragma once

#include <filesystem>
#include <optional>

#include "crumple/io.h"
#include "io/bytes/source.h"

namespace crumple::io {

/// Reads the scene of a glTF file as bodies. Several bodies may have the same name. `folder`: folder in which other
/// files that the glTF file refers to are found; none for a stream. Throws Error (format, file).
WorldMesh read_gltf(const Source& source, std::optional<std::filesystem::path> folder, const ReadOptions& options,
                    Warnings& warnings);

}  // namespace crumple::io
