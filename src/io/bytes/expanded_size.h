#pragma once

// Limit on the size of decompressed data, against decompression bombs. Real meshes compress to a fifth or a tenth of
// their size; deflate can compress a thousandfold.

#include <algorithm>
#include <cstdint>

namespace crumple::io {

inline constexpr std::uint64_t always_allowed_bytes = std::uint64_t{256}
                                                      << 20;  ///< number of expanded bytes that is allowed for any file
inline constexpr std::uint64_t most_ratio = 100;
inline constexpr const char* expansion_rule =
    "to more than 256 MiB, and to more than a hundred times the size of the file";

inline std::uint64_t expansion_limit(std::uint64_t compressed) {
    return std::max(always_allowed_bytes, most_ratio * compressed);
}

}  // namespace crumple::io
