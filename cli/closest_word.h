#pragma once

// Finds, for a misspelt word, the known word that was probably meant.

#include <span>
#include <string>

namespace crumple::cli {

/// Returns the known word closest to `word`: one that begins with `word` (of three letters or more), or that differs
/// from it in at most a third of its letters. Returns null if there is none.
const std::string* nearest(const std::string& word, std::span<const std::string> known);

}  // namespace crumple::cli
