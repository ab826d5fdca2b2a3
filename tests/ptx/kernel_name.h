#pragma once

// Mangled names of the kernels that this program holds, by which the PTX of a kernel is found.

#include <string>

namespace crumple::ptx {

/// The symbol at an address within this program; empty if there is none.
std::string symbol_at(const void* address);

/// The name with the same word for every anonymous namespace, which each compiler names in its own way.
std::string without_file(std::string name);

}  // namespace crumple::ptx
