#pragma once

// Scenes made by formula, for tests, benchmarks, examples and the command line.
//
// A scene is the same, bit for bit, on every machine: it comes from its parameters through integer hashes and the four
// operations and square root of IEEE arithmetic alone (scenes/arithmetic.h), without contraction.

#include <cstdint>
#include <span>
#include <string_view>

#include "crumple/io.h"

namespace crumple::scenes {

struct Parameters {
    std::int64_t triangles = 0;  ///< about as many; 0: the scene's default
    int frame = 0;               ///< 0 to Description::frames - 1
    std::uint64_t seed = 1;      ///< other numbers give other scenes of the same kind
};

struct Description {
    std::string_view name;
    std::string_view summary;  ///< one line
    std::int64_t triangles;    ///< default
    int frames;                ///< 1: it does not move
};

/// Every scene, in the order to list them in.
std::span<const Description> descriptions();

/// Makes a scene. The number of triangles is within a tenth of what was asked for, from ten thousand on; few triangles
/// may be too few for a scene to be what it is, and then it has more.
/// Throws Error (invalid_argument) for a name that is unknown, naming the known ones, a frame that does not exist, or a
/// number of triangles that is negative or above half a thousand million.
io::TriangleMesh make(std::string_view name, const Parameters& parameters = {});

}  // namespace crumple::scenes
