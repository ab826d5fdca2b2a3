#pragma once

// What an answer about worlds side by side has beside that about their scene: pairs by bodies, and numbers by world.
// All follows from the pairs in their order, whose offsets tell where a world's begin.

#include <cstdint>

#include "backends/cuda/stages/output.h"
#include "crumple/world.h"
#include "scene/wanted_pairs.h"

namespace crumple::cuda {

/// How a scene's triangles are named as those of bodies. Pointers of the device.
struct WorldNames {
    const std::int32_t* classes_of = nullptr;      ///< by triangle
    const BodyClass* classes = nullptr;            ///< by class
    const std::int32_t* first_of_class = nullptr;  ///< by class: the first triangle of its body
    const std::int64_t* first_of_world = nullptr;  ///< by world the first triangle; worlds + 1
    std::int32_t worlds = -1;                      ///< -1: the scene is not made of worlds
    bool pairs = false;                            ///< whether pairs are wanted by bodies
    friend bool operator==(const WorldNames&, const WorldNames&) = default;

    bool any() const { return worlds >= 0; }
};

struct WorldArrays {
    BodyPair* bodies = nullptr;       ///< by pair
    Pair* pairs = nullptr;            ///< triangles within these
    std::int64_t* offsets = nullptr;  ///< worlds + 1
    std::int64_t* counts = nullptr;
    std::uint8_t* hit = nullptr;
};

/// After the output's pairs of `firsts` first triangles are in order.
void name_pairs(const Geometry& geometry, cudaStream_t stream, std::size_t firsts, const OutputArrays& output,
                const WorldNames& names, const WorldArrays& arrays);

}  // namespace crumple::cuda
