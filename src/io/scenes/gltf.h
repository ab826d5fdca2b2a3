#pragma once

#include <filesystem>
#include <optional>

#include "crumple/io.h"
#include "io/bytes/source.h"

namespace crumple::io {

/// Reads the scene of a glTF file as bodies. Their names may repeat. `folder`: folder of the files that it names; none
/// for a stream. Throws Error (format, file).
WorldMesh read_gltf(const Source& source, std::optional<std::filesystem::path> folder, const ReadOptions& options,
                    Warnings& warnings);

}  // namespace crumple::io
