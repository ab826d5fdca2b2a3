#pragma once

// Handmade arrays of NumPy.

#include "files.h"

namespace crumple::io::test {

/// Returns a .npy file.
inline std::string npy(const std::string& type, const std::string& shape, const std::string& data,
                       bool by_column = false) {
    const std::string header = "{'descr': '" + type + "', 'fortran_order': " + (by_column ? "True" : "False") +
                               ", 'shape': " + shape + ", }\n";
    return std::string("\x93NUMPY\x01\0", 8) + packed(std::endian::little, static_cast<std::uint16_t>(header.size())) +
           header + data;
}

}  // namespace crumple::io::test
