#pragma once

#include <string>

#include "fuzz/decode.h"

namespace crumple::fuzz {

std::string as_code(const Options& options);
/// `name` follows the names of its arrays.
std::string as_code(const Mesh& mesh, const std::string& name);

/// The search as C++ that a test can take over: options, query, and the arrays of each frame, to the last bit.
std::string as_code(const Search& search);

}  // namespace crumple::fuzz
