#pragma once

#include <cstdint>

namespace crumple {

/// What a step of the decision knows about a pair of triangles. `apart` and `collides` are final.
enum class Verdict : std::uint8_t { apart, collides, undecided };

}  // namespace crumple
