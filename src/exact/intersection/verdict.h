#pragma once

#include <cstdint>

namespace crumple {

/// Result of one step of the decision about a pair of triangles. `apart` and `collides` are final.
enum class Verdict : std::uint8_t { apart, collides, undecided };

}  // namespace crumple
