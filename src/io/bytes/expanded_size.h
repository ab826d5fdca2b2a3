#pragma once

// How large what is compressed may become. Honest meshes shrink to a fifth or a tenth; deflate can shrink a
// thousandfold.

#include <algorithm>
#include <cstdint>

namespace crumple::io {

inline constexpr std::uint64_t always_expanded = std::uint64_t{256} << 20;  ///< however small the file
inline constexpr std::uint64_t most_ratio = 100;
inline constexpr const char* expansion_rule = "more than 256 MiB, and than a hundred times the file";

inline std::uint64_t most_expanded(std::uint64_t compressed) {
    return std::max(always_expanded, most_ratio * compressed);
}

}  // namespace crumple::io
