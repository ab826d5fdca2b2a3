// Welding with a hash table of distinct vertices (open addressing). Distinct vertices move to the front of the array in
// place: there are never more of them than vertices visited so far.

#include "io/meshes/weld.h"

#include <algorithm>
#include <array>

#include "geometry/position_hash.h"
#include "io/bytes/large_pages.h"

namespace crumple::io {
namespace {

// Hash table of distinct positions, which grows with their number: a small one stays in the cache. A slot holds the
// vertex at the position, or -1. The table has capacity for a block of `block` positions without growing in between, so
// that their slots can be prefetched.
class PositionTable {
   public:
    static constexpr std::size_t block = 64;

    /// Reserves capacity for another block. `hash(v)` returns the hash of a vertex of the table.
    template <class HashOf>
    void reserve_block(std::size_t kept, HashOf hash) {
        if (2 * (kept + block) <= slots_.size()) return;
        const std::size_t size = 4 * std::max(slots_.size(), block);
        slots_.clear();
        reserve_large(slots_, size);
        slots_.resize(size, -1);
        for (std::int32_t v = 0; v < static_cast<std::int32_t>(kept); ++v) {
            std::size_t slot = hash(v) & mask();
            while (slots_[slot] >= 0) slot = (slot + 1) & mask();
            slots_[slot] = v;
        }
    }
    void prefetch(std::uint64_t hash) const { __builtin_prefetch(&slots_[hash & mask()]); }
    /// Returns the slot of the position with this hash for which is_same(vertex) is true, or an empty slot for it.
    template <class IsSame>
    std::int32_t& find(std::uint64_t hash, IsSame is_same) {
        std::size_t slot = hash & mask();
        while (slots_[slot] >= 0 && !is_same(slots_[slot])) slot = (slot + 1) & mask();
        return slots_[slot];
    }

   private:
    std::size_t mask() const { return slots_.size() - 1; }
    std::vector<std::int32_t> slots_;
};

template <class Scalar>
void weld(std::vector<Scalar>& xyz, TriangleMesh& mesh) {
    const std::size_t count = xyz.size() / 3;
    const PositionHash hash;
    const auto at = [&](std::size_t v) { return &xyz[3 * v]; };
    const auto hash_of = [&](std::size_t v) {
        const Scalar* const p = at(v);
        return hash(Vec3<Scalar>{p[0], p[1], p[2]});
    };
    PositionTable table;
    std::vector<std::int32_t> renamed;
    reserve_large(renamed, count);
    std::size_t kept = 0;
    for (std::size_t begin = 0; begin < count; begin += PositionTable::block) {
        const std::size_t size = std::min(PositionTable::block, count - begin);
        table.reserve_block(kept, [&](std::int32_t v) { return hash_of(static_cast<std::size_t>(v)); });
        std::array<std::uint64_t, PositionTable::block> hashes;
        for (std::size_t i = 0; i < size; ++i) table.prefetch(hashes[i] = hash_of(begin + i));
        for (std::size_t i = 0; i < size; ++i) {
            const Scalar* const p = at(begin + i);
            std::int32_t& vertex = table.find(hashes[i], [&](std::int32_t v) {
                const Scalar* const q = at(static_cast<std::size_t>(v));
                return p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
            });
            if (vertex < 0) {
                for (std::size_t axis = 0; axis < 3; ++axis) xyz[3 * kept + axis] = p[axis];
                vertex = static_cast<std::int32_t>(kept++);
            }
            renamed.push_back(vertex);
        }
    }
    xyz.resize(3 * kept);
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
