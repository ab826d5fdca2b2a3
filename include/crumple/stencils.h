#pragma once

#include <array>
#include <cstdint>

#include "crumple/array.h"
#include "crumple/export.h"
#include "crumple/features.h"
#include "crumple/impacts.h"
#include "crumple/proximities.h"
#include "crumple/scene.h"

namespace crumple {

/// Origin of the normal of a stencil (docs/nearness.md, Normals).
enum class NormalFrom : std::uint8_t {
    none,    ///< there is no direction: the normal is 0
    apart,   ///< the features are apart: from the nearest point of the second feature to that of the first
    before,  ///< they touch: perpendicular to both, on the side where the first feature was before
    rest,    ///< they touch: perpendicular to both, on the side where the first feature is in the rest shape
};

/// Options of stencils().
struct StencilOptions {
    /// Earlier positions of all vertices, (n, 3), float32 or float64, for the normals of pairs that touch. For worlds
    /// and two meshes: posed, body after body. Without data there are none.
    VertexView before = {};
    /// Rest shape, in the form of `before`: its orientation decides where `before` does not. Also the lengths of edges
    /// for `parallel`; without data the scene itself is used for these.
    VertexView rest = {};
    /// Replaces each pair by its closest parts, and merges equal rows (Stencils::multiplicity).
    bool reduced = false;
    /// With `reduced`: two edges e and f stay a pair of edges if |e x f|² < parallel |e'|² |f'|², where e' and f' are
    /// the edges in the rest shape. Finite, 0 or more. The mollifier of IPC needs 1e-3.
    double parallel = 0;
    int threads = 0;  ///< number of threads; 0: as many as the machine has
};

/// Pairs of features in the form that solvers need: for each pair, a row with vertices, weights, normal and distance.
/// For all rows, with x the positions of the vertices, (sum of w_k x_k) is the vector from the nearest point of the
/// second feature to that of the first, up to rounding. Its length is the distance; the derivative of the distance by
/// x_k is w_k times the normal.
struct Stencils {
    /// Rows of kind k are [first[k], first[k + 1]), in the order of FeatureKind. Without `reduced`, these are the pairs
    /// of the list of this kind, in its order. With it, rows of a kind are sorted by their vertices.
    std::array<std::int64_t, feature_kinds + 1> first{};
    /// The vertices of the first feature, then those of the second: vertex and face, edge and edge, vertex and edge,
    /// two vertices. The last vertex is repeated, with weight 0, if there are fewer than four. For worlds and two
    /// meshes: vertex v of body b is first_vertex[b] + v.
    Array<std::array<std::int32_t, 4>> vertices;
    /// Barycentric coordinates of the nearest points: sum 1 over the first feature, -1 over the second. Rounded;
    /// exactly 0 for vertices outside of the closest parts.
    Array<std::array<double, 4>> weights;
    Array<std::array<double, 3>> normals;  ///< of length 1, from the second feature to the first; 0: no direction
    Array<double> distance;                ///< Euclidean, rounded; infinite if its square overflows
    Array<std::uint8_t> normal_from;       ///< a NormalFrom
    /// Closest parts: a VertexFaceType, EdgeEdgeType, VertexEdgeType or VertexVertexType, by the kind of the row.
    Array<std::uint8_t> type;

    // For StencilOptions::reduced:
    Array<std::int32_t> multiplicity;  ///< number of pairs that a row replaces, 1 or more
    Array<std::int64_t> row_of_pair;   ///< row of each pair, for the pairs of all lists, one list after the other

    /// For worlds and two meshes: body b has the vertices [first_vertex[b], first_vertex[b + 1]). For one mesh {0, n}.
    Array<std::int64_t> first_vertex;

    /// Returns the number of rows.
    std::size_t size() const { return distance.size(); }
};

/// Returns the stencils of near pairs at the positions at which they were found: the start, if the scene moves. The
/// scene is that of the query, in host memory, with the same vertices. ProximityQuery::closest saves half of the work
/// here.
///
/// Throws Error: invalid_argument if the result lists no pairs, or does not fit the scene (a feature that does not
/// exist); if an array has the wrong number of rows, or an option is invalid; if the scene is a part or in device
/// memory; not_finite; index_out_of_range. Thread-safe. The bytes do not depend on threads. Cost per pair: about 0.2
/// us, without `closest` 0.4 us; `reduced`, which sorts the pairs, adds 0.2 us. Source of `reduced`: M. Li et al.,
/// "Incremental Potential Contact" (2020).
CRUMPLE_API Stencils stencils(const Scene& scene, const Proximities& found, const StencilOptions& options = {});

/// Returns the stencils of impacts at the time of each impact: its toi. Positions at that time are rounded, and pairs
/// with a distance of at most 2^-32 times the largest coordinate of their vertices count as touching: their normals are
/// those of NormalFrom::before, by the motion of the step, unless they touch at the start. All else is as above.
CRUMPLE_API Stencils stencils(const Scene& scene, const Impacts& found, const StencilOptions& options = {});

}  // namespace crumple
