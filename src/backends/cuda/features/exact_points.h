#pragma once

// Coordinates of feature vertices, as exact decisions read them.

#include "backends/cuda/features/feature_parameters.h"
#include "backends/cuda/stages/positions.h"
#include "filters/features/feature_points.h"

namespace crumple::cuda {

/// Access to the caller's own coordinates; filters read normalised ones.
struct ExactPoints {
    PreparedScene scene;
    bool aligned;
    friend bool operator==(const ExactPoints&, const ExactPoints&) = default;

    CRUMPLE_HD Vec3d start(std::int32_t v) const {
        return aligned ? position<true>(scene, static_cast<std::size_t>(v))
                       : position<false>(scene, static_cast<std::size_t>(v));
    }
    CRUMPLE_HD MovingPoint moving(std::int32_t v) const {
        const Vec3d from = start(v);
        if (!scene.moving) return {from, from};
        return {from, aligned ? end_position<true>(scene, static_cast<std::size_t>(v))
                              : end_position<false>(scene, static_cast<std::size_t>(v))};
    }
    CRUMPLE_HD FeaturePoints moving(const std::int32_t (&v)[4]) const {
        return {moving(v[0]), moving(v[1]), moving(v[2]), moving(v[3])};
    }
    CRUMPLE_HD std::array<Vec3d, 4> start(const std::int32_t (&v)[4]) const {
        return {start(v[0]), start(v[1]), start(v[2]), start(v[3])};
    }
};

}  // namespace crumple::cuda
