#pragma once

// File names of an animation's frames.

#include <cstddef>
#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "io/bytes/gzip.h"

namespace crumple::cli {

/// Returns the file name of frame `number` of `count`: cloth07.ply for cloth.ply and frame 7 of 94. All numbers have as
/// many digits as the last one.
inline std::string numbered(const std::string& path, std::size_t number, std::size_t count) {
    const std::filesystem::path file = io::without_gzip_name(path);
    const std::size_t digits = std::to_string(count > 0 ? count - 1 : 0).size();
    return (file.parent_path() / fmt::format("{}{:0{}}{}{}", file.stem().string(), number, digits,
                                             file.extension().string(),
                                             io::has_gzip_name(path) ? path.substr(path.size() - 3) : ""))
        .string();
}

}  // namespace crumple::cli
