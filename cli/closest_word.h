#pragma once

// Finds the known word that was probably meant by an unknown one.

#include <span>
#include <string>

namespace crumple::cli {

/// Returns the known word that begins with this one, or that differs from it in at most a third of its letters; null if
/// there is none.
const std::string* nearest(const std::string& word, std::span<const std::string> known);

}  // namespace crumple::cli
