#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "crumple/crumple.h"

namespace crumple::test {

/// Two meshes over the vertices of one: `a` has its triangles with even indices, `b` those with odd ones.
class Halves {
   public:
    explicit Halves(const MeshView& mesh) : a(mesh), b(mesh) {
        take(a, 0);
        take(b, 1);
    }
    Halves(const Halves&) = delete;
    Halves& operator=(const Halves&) = delete;

    MeshView a, b;

   private:
    void take(MeshView& mesh, std::size_t side) {
        for (std::size_t t = side; t < mesh.groups.size(); t += 2) groups_[side].push_back(mesh.groups[t]);
        mesh.groups = groups_[side];
        TriangleView& t = mesh.triangles;
        if (t.rows > 0) t.data = static_cast<const char*>(t.data) + static_cast<std::int64_t>(side) * t.row_stride;
        t.rows = (t.rows + 1 - static_cast<std::int64_t>(side)) / 2;
        t.row_stride *= 2;
    }

    std::array<std::vector<std::int32_t>, 2> groups_;
};

}  // namespace crumple::test
