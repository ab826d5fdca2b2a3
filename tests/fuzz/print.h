#pragma once

#include <string>

#include "fuzz/decode.h"

namespace crumple::fuzz {

/// The search as C++ that a test can take over: options, query, and the arrays of each frame, to the last bit.
std::string as_code(const Search& search);

}  // namespace crumple::fuzz
