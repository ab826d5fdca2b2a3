#pragma once

// Batch of pairs of static features that are known to be near, in columns for SIMD lanes (squared_distances-inl.h). It
// holds the points whose differences are the vectors of VectorsFromGuess, and the same s and t.

#include <algorithm>
#include <cstddef>
#include <limits>

#include "exact/proximity/vectors_from_guess.h"

namespace crumple::cpu {

struct GuessBatch {
    static constexpr std::size_t most = 64;
    using Column = double[most];

    // w = x0 - y0, u = x1 - x0, v = v1 - v0; s and t are 0 unless they are free.
    alignas(64) Column x0[3] = {}, x1[3] = {}, y0[3] = {}, v0[3] = {}, v1[3] = {};
    alignas(64) Column s = {}, t = {};
    alignas(64) Column free = {};  ///< number of free parameters: 0, 1 or 2
    std::size_t count = 0;

    void add(const Features& features, const detail::Guess& guess) {
        const detail::Numbering order = detail::numbering(features.kinds, guess.type);
        const auto set = [&](Column(&column)[3], std::size_t i) {
            const Vec3d& p = features.point[order.point[i]];
            column[0][count] = p.x, column[1][count] = p.y, column[2][count] = p.z;
        };
        const bool face = features.kinds == FeatureKinds::vertex_face,
                   edges = features.kinds == FeatureKinds::edge_edge;
        set(x0, 0);
        set(x1, features.kinds == FeatureKinds::vertex_vertex ? 0 : 1);
        set(y0, 2);
        set(v0, edges ? 3 : 0);
        set(v1, face ? 3 : edges ? 2 : 0);
        s[count] = order.free > 0 ? (order.second ? guess.t : guess.s) : 0;
        t[count] = order.free > 1 ? guess.t : 0;
        free[count] = order.free;
        ++count;
    }
};

/// Leaves all squared distances unresolved, as NaN: for kernel tables that do not compute them.
inline void leave_unresolved(const GuessBatch& batch, double* squared) {
    std::fill_n(squared, batch.count, std::numeric_limits<double>::quiet_NaN());
}

}  // namespace crumple::cpu
