// Welding with a hash table of distinct vertices (open addressing). Distinct vertices move to the front of the array in
// place: there are never more of them than vertices visited so far.

#include "io/meshes/weld.h"

#include <bit>

#include "geometry/position_hash.h"

namespace crumple::io {
namespace {

template <class Scalar>
void weld(std::vector<Scalar>& xyz, TriangleMesh& mesh) {
    const std::size_t count = xyz.size() / 3;
    const PositionHash hash;
    const std::size_t mask = std::bit_ceil(2 * count + 1) - 1;
    std::vector<std::int32_t> table(mask + 1, -1), renamed(count);
    std::int32_t kept = 0;
    for (std::size_t v = 0; v < count; ++v) {
        const Scalar* const p = &xyz[3 * v];
        std::size_t slot = hash(Vec3d{double{p[0]}, double{p[1]}, double{p[2]}}) & mask;
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
    const auto rename = [&](std::int32_t& vertex) { vertex = renamed[static_cast<std::size_t>(vertex)]; };
    for (std::vector<std::int32_t>* const names : {&mesh.triangles, &mesh.polygons.corners, &mesh.points})
        for (std::int32_t& vertex : *names) rename(vertex);
    for (Edge& line : mesh.lines) {
        rename(line.a);
        rename(line.b);
        if (line.a == line.b) mesh.points.push_back(line.a);  // both ends were welded
    }
    std::erase_if(mesh.lines, [](const Edge& line) { return line.a == line.b; });
}

}  // namespace

void weld(TriangleMesh& mesh) {
    std::visit([&](auto& xyz) { weld(xyz, mesh); }, mesh.vertices);
}

}  // namespace crumple::io
