#pragma once

// Which known word was meant by one that is unknown.

#include <span>
#include <string>

namespace crumple::cli {

/// The one of the words that begins with this one, or that differs from it in at most a third of its letters; null if
/// there is none.
const std::string* nearest(const std::string& word, std::span<const std::string> known);

}  // namespace crumple::cli
