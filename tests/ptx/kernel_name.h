#pragma once

// Mangled names of this program's kernels, by which the PTX of a kernel is found.

#include <string>

namespace crumple::ptx {

/// Returns the symbol at an address within this program; empty if there is none.
std::string symbol_at(const void* address);

/// Returns the name with one spelling for all anonymous namespaces, which each compiler mangles in its own way.
std::string without_file(std::string name);

}  // namespace crumple::ptx
