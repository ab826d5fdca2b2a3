#pragma once

#include <cstring>

#include "cuda/cloth.h"
#include "features/moving_soups.h"

namespace crumple::test {

/// Returns the step from a frame of a cloth, which falls on a ball, to the next frame, in float32.
inline MovingSoup<float> falling(int triangles, int frame) {
    MovingSoup<float> soup;
    const io::TriangleMesh from = cloth(triangles, frame), to = cloth(triangles, frame + 1);
    const auto points = [](const io::TriangleMesh& mesh, auto& out) {
        const VertexView view = mesh.view().vertices;
        for (std::int64_t v = 0; v < view.rows; ++v) {
            PointOf<float> p;
            const auto* row = static_cast<const std::byte*>(view.data) + v * view.row_stride;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const auto* place = row + static_cast<std::int64_t>(axis) * view.column_stride;
                if (view.type == ScalarType::float32) {
                    std::memcpy(&p[axis], place, sizeof p[axis]);
                } else {
                    double x;
                    std::memcpy(&x, place, sizeof x);
                    p[axis] = static_cast<float>(x);
                }
            }
            out.push_back(p);
        }
    };
    points(from, soup.start);
    points(to, soup.end);
    const MeshView view = from.view();
    for (std::int64_t t = 0; t < view.triangles.rows; ++t) {
        std::array<std::int32_t, 3> corner;
        for (std::size_t k = 0; k < 3; ++k)
            std::memcpy(&corner[k],
                        static_cast<const std::byte*>(view.triangles.data) + t * view.triangles.row_stride +
                            static_cast<std::int64_t>(k) * view.triangles.column_stride,
                        sizeof corner[k]);
        soup.triangles.push_back(corner);
    }
    return soup;
}

}  // namespace crumple::test
