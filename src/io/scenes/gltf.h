#pragma once

#include <filesystem>
#include <optional>

#include "crumple/io.h"
#include "io/bytes/source.h"

namespace crumple::io {

/// Bodies without a name have none yet, and names may repeat. `folder`: where files that it names lie; none for a
/// stream.
WorldMesh read_gltf(const Source& source, std::optional<std::filesystem::path> folder, const ReadOptions& options,
                    Warnings& warnings);

}  // namespace crumple::io
