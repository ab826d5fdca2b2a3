#pragma once

// Kernel parameters of a feature query. Pointers are to device memory.

#include <cstdint>

#include "backends/cuda/device/runtime.h"
#include "geometry/inflation.h"
#include "scene/feature_table.h"

namespace crumple::cuda {

/// Device copy of VertexRings: the vertices near each vertex. Of vertices that are welded, only the representative
/// (FeatureTable::name) has a ring and is in rings.
struct RingTable {
    const std::int32_t* of = nullptr;     ///< rings, one after another, each ascending; null: no rings
    const std::int64_t* first = nullptr;  ///< start of each vertex's ring in `of`; and the end
    friend bool operator==(const RingTable&, const RingTable&) = default;

    __device__ bool joined(std::int32_t name, std::int32_t other) const {
        std::int64_t begin = first[name], end = first[name + 1];
        while (begin < end) {
            const std::int64_t middle = (begin + end) / 2;
            if (of[middle] == other) return true;
            if (of[middle] < other)
                begin = middle + 1;
            else
                end = middle;
        }
        return false;
    }
};

/// Device copy of RestShape.
struct RestTable {
    const double* position = nullptr;  ///< 3 values per vertex; null: no rest shape
    const std::int32_t* body = nullptr;
    double radius = 0;
    friend bool operator==(const RestTable&, const RestTable&) = default;

    CRUMPLE_HD bool knows(std::int32_t v, std::int32_t w) const {
        return position && (!body || (body[v] >= 0 && body[v] == body[w]));
    }
    CRUMPLE_HD Vec3d operator()(std::int32_t v) const {
        const double* p = position + 3 * static_cast<std::int64_t>(v);
        return {p[0], p[1], p[2]};
    }
};

/// Returns a non-null address that stands for any array, for keys of graphs that do not depend on addresses.
template <class T>
const T* unknown() {
    return reinterpret_cast<const T*>(alignof(T));
}

struct FeatureConditions {
    bool motion = false, strict = false, approaching_only = false;
    double distance = 0, share = 0;
    const double* radii = nullptr;  ///< by vertex; null: `distance` holds for all features
    RestTable rest;
    RingTable rings;
    FeatureTable features;
    // In normalised coordinates, rounded up:
    const Inflation* inflation = nullptr;
    const float *vertex_radius = nullptr, *triangle_radius = nullptr;

    friend bool operator==(const FeatureConditions&, const FeatureConditions&) = default;

    /// Removes addresses and values on which the choice of kernels does not depend, for GraphKey::shape().
    void forget_places() {
        radii = radii ? unknown<double>() : nullptr;
        rest.position = rest.position ? unknown<double>() : nullptr;
        rest.body = rest.body ? unknown<std::int32_t>() : nullptr;
        rings = rings.of ? RingTable{unknown<std::int32_t>(), nullptr} : RingTable{};
        features = {};
        inflation = nullptr;
        vertex_radius = triangle_radius = radii ? unknown<float>() : nullptr;
        distance = distance > 0;
        share = share > 0;
    }

    bool separated() const { return motion && (distance > 0 || share > 0); }
};

}  // namespace crumple::cuda
