#pragma once

// Wraps mutated contents in the containers of file formats. The lengths that a container states are always those of the
// contents, so that readers do not refuse mutated contents because of a length.

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>

#include "io/bytes/bytes.h"

namespace crumple::fuzz {

template <class T>
std::string bytes_of(T value) {
    const auto little = io::little_endian(value);
    return {little.begin(), little.end()};
}

/// Returns a .glb file: the JSON description ends at the first byte 0 of `bytes`; the rest is the binary chunk.
inline std::string glb_of(std::string_view bytes) {
    const std::size_t end = std::min(bytes.find('\0'), bytes.size());
    const std::string_view json = bytes.substr(0, end), binary = bytes.substr(std::min(end + 1, bytes.size()));
    const auto word = [](std::size_t value) { return bytes_of(static_cast<std::uint32_t>(value)); };
    std::string file = "glTF" + word(2) + word(12 + 8 + json.size() + 8 + binary.size());
    file.append(word(json.size())).append("JSON").append(json);
    return file.append(word(binary.size())).append("BIN\0", 4).append(binary);
}

/// Returns the header of a .npy file.
inline std::string npy_header(const std::string& description) {
    return std::string("\x93NUMPY\1\0", 8) + bytes_of(static_cast<std::uint16_t>(description.size() + 1)) +
           description + '\n';
}

/// Returns a .npy file with as many poses as `bytes` can hold. The first byte chooses the type of the numbers and the
/// shape of the array.
inline std::string npy_of_poses(std::string_view bytes) {
    constexpr const char* types[] = {"<f8", "<f4", ">f8", ">f4"};
    constexpr const char* rows[] = {", 12)", ", 3, 4)", ", 16)", ", 4, 4)"};
    const std::size_t kind = bytes.empty() ? 0 : static_cast<unsigned char>(bytes[0]) % 16;
    bytes.remove_prefix(std::min<std::size_t>(bytes.size(), 1));
    const std::size_t row = (kind / 4 < 2 ? 12u : 16u) * (kind % 2 == 0 ? 8u : 4u), count = bytes.size() / row;
    return npy_header("{'descr': '" + std::string(types[kind % 4]) + "', 'fortran_order': False, 'shape': (" +
                      std::to_string(count) + rows[kind / 4] + ", }") +
           std::string(bytes.substr(0, count * row));
}

}  // namespace crumple::fuzz
