#pragma once

// File names of an animation's frames.

#include <cstddef>
#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "io/bytes/gzip.h"

namespace crumple::cli {

/// Returns cloth07.ply for cloth.ply, number 7 of 94: with as many digits as the last number needs.
inline std::string numbered(const std::string& path, std::size_t number, std::size_t count) {
    const std::filesystem::path file = io::without_gzip_name(path);
    const std::size_t digits = std::to_string(count > 0 ? count - 1 : 0).size();
    return (file.parent_path() / fmt::format("{}{:0{}}{}{}", file.stem().string(), number, digits,
                                             file.extension().string(),
                                             io::has_gzip_name(path) ? path.substr(path.size() - 3) : ""))
        .string();
}

}  // namespace crumple::cli
