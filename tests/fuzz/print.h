#pragma once

#include <string>

#include "fuzz/decode.h"

namespace crumple::fuzz {

std::string as_code(const Options& options);
/// Appends `name` to the names of the arrays.
std::string as_code(const Mesh& mesh, const std::string& name);

/// Returns C++ code that can be pasted into a test: options, query, and the exact arrays of each frame.
std::string as_code(const Search& search);

}  // namespace crumple::fuzz
