// Welding by a hash table of kept vertices, open addressing. Vertices that are kept move to the front in place: there
// are never more of them than have been seen. The hash has a random seed, so that no file can be made to be slow; the
// result does not depend on it.

#include "io/weld.h"

#include <bit>
#include <random>

namespace crumple::io {

namespace {

/// Finaliser of MurmurHash3: every bit of the result depends on every bit of the argument.
std::uint64_t mix(std::uint64_t h) {
    h = (h ^ (h >> 33)) * 0xff51afd7ed558ccdull;
    h = (h ^ (h >> 33)) * 0xc4ceb9fe1a85ec53ull;
    return h ^ (h >> 33);
}

template <class Scalar>
void weld(std::vector<Scalar>& xyz, std::vector<std::int32_t>& triangles) {
    const std::size_t count = xyz.size() / 3;
    std::random_device random;
    const std::uint64_t seed = (std::uint64_t{random()} << 32) | random();
    const std::size_t mask = std::bit_ceil(2 * count + 1) - 1;
    std::vector<std::int32_t> table(mask + 1, -1), renamed(count);
    std::int32_t kept = 0;
    for (std::size_t v = 0; v < count; ++v) {
        const Scalar* const p = &xyz[3 * v];
        std::uint64_t hash = seed;
        for (int axis = 0; axis < 3; ++axis) {
            hash = mix(hash ^ std::bit_cast<std::uint64_t>(double{p[axis]} + 0.0));  // -0 + 0 is +0
        }
        std::size_t slot = hash & mask;
        for (; table[slot] >= 0; slot = (slot + 1) & mask) {
            const Scalar* const q = &xyz[3 * static_cast<std::size_t>(table[slot])];
            if (p[0] == q[0] && p[1] == q[1] && p[2] == q[2]) break;
        }
        if (table[slot] < 0) {
            for (std::size_t axis = 0; axis < 3; ++axis) xyz[3 * static_cast<std::size_t>(kept) + axis] = p[axis];
            table[slot] = kept++;
        }
        renamed[v] = table[slot];
    }
    xyz.resize(3 * static_cast<std::size_t>(kept));
    xyz.shrink_to_fit();
    for (std::int32_t& corner : triangles) corner = renamed[static_cast<std::size_t>(corner)];
}

}  // namespace

void weld(TriangleMesh& mesh) {
    std::visit([&](auto& xyz) { weld(xyz, mesh.triangles); }, mesh.vertices);
}

}  // namespace crumple::io
