#pragma once

// Additions to a result for worlds side by side: pairs by bodies, and offsets, counts and flags by world. All follow
// from the sorted pairs of the scene, whose offsets give the first pair of each world.

#include <cstdint>

#include "backends/cuda/stages/output.h"
#include "crumple/world.h"
#include "scene/pair_selection.h"

namespace crumple::cuda {

/// Tables that translate triangles of the scene to triangles of bodies. A class is the set of triangles of one body and
/// one group (BodyClass). Pointers refer to device memory.
struct WorldNames {
    const std::int32_t* classes_of = nullptr;      ///< class of each triangle of the scene
    const BodyClass* classes = nullptr;            ///< body and group of each class
    const std::int32_t* first_of_class = nullptr;  ///< by class: first triangle of its body in the scene
    const std::int64_t* first_of_world = nullptr;  ///< by world: first triangle; worlds + 1
    std::int32_t worlds = -1;                      ///< -1: the scene is not made of worlds
    bool pairs = false;                            ///< true if pairs by bodies are requested
    friend bool operator==(const WorldNames&, const WorldNames&) = default;

    bool any() const { return worlds >= 0; }
};

struct WorldArrays {
    BodyPair* bodies = nullptr;       ///< bodies of each pair
    Pair* pairs = nullptr;            ///< triangles within these bodies
    std::int64_t* offsets = nullptr;  ///< first pair of each world; worlds + 1
    std::int64_t* counts = nullptr;
    std::uint8_t* hit = nullptr;
};

/// Fills the arrays from the output, whose pairs must be sorted; `firsts` is its number of first triangles.
void name_pairs(const Geometry& geometry, cudaStream_t stream, std::size_t firsts, const OutputArrays& output,
                const WorldNames& names, const WorldArrays& arrays);

}  // namespace crumple::cuda
