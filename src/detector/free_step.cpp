// A step that is cut short before the first contact: tried, and verified as it is rounded.

#include "detector/free_step.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/float_environment.h"
#include "scene/prepared_scene.h"

namespace crumple {
namespace {

VertexReader reader_of(const VertexView& view) {
    return {static_cast<const std::byte*>(view.data), view.row_stride, view.column_stride,
            view.type == ScalarType::float32};
}

// What is left of the time of contact, one try after the other.
double shortened(double toi, int attempt) {
    constexpr std::array<int, 4> bits{16, 8, 4, 2};
    if (attempt < 4) return toi * (1 - std::ldexp(1.0, -bits[static_cast<std::size_t>(attempt)]));
    return std::ldexp(toi, 3 - attempt);
}

}  // namespace

void find_free_step(const MeshView& mesh, bool triangle_pairs, FunctionRef<FirstImpact(const MeshView&)> first_impact,
                    FunctionRef<bool(const MeshView&)> is_free, FreeStep& step) {
    constexpr double least_share = 0x1p-40;
    const FirstImpact first = first_impact(mesh);
    const FloatEnvironment environment;
    const bool float32 = mesh.vertices.type == ScalarType::float32 && mesh.end.type == ScalarType::float32;
    const VertexReader from = reader_of(mesh.vertices), to = reader_of(mesh.end);
    step.positions.resize_discard(static_cast<std::size_t>(3 * mesh.vertices.rows));
    const auto go = [&](double share) {
        step.share = share;
        for (std::int64_t v = 0; v < mesh.vertices.rows; ++v) {
            const Vec3d a = from(v), b = to(v);
            for (int axis = 0; axis < 3; ++axis) {
                // At the ends exact; between them a product that may not overflow.
                const double x = share == 0 ? a[axis] : share == 1 ? b[axis] : (1 - share) * a[axis] + share * b[axis];
                step.positions[3 * v + axis] = float32 ? static_cast<double>(static_cast<float>(x)) : x;
            }
        }
    };
    // What intersects at the start does so at every share of the step.
    const bool stuck = triangle_pairs && !is_free(mesh.moving_to(mesh.vertices));
    go(first.found || stuck ? 0 : 1);
    if (!first.found || stuck) return;
    const VertexView there{step.positions.data(), mesh.vertices.rows, 24, 8, ScalarType::float64};
    for (int attempt = 0; shortened(first.toi, attempt) >= least_share; ++attempt) {
        go(shortened(first.toi, attempt));
        if (is_free(mesh.moving_to(there))) return;
    }
    go(0);
}

}  // namespace crumple
