#pragma once

#include <array>
#include <cstdint>

#include "crumple/array.h"
#include "crumple/intersections.h"
#include "crumple/query.h"
#include "crumple/world.h"

namespace crumple {

struct Overlaps;

/// Vertex of a body: `vertex` is an index into the vertices of the body's shape.
struct BodyVertex {
    std::int32_t body, vertex;
    friend bool operator==(const BodyVertex&, const BodyVertex&) = default;
};

/// Query for overlaps of closed bodies: their volume, their centroid, and the direction in which to move a body to
/// reduce them (docs/overlap.md). A value: it owns its data.
///
/// A surface is closed if each edge occurs in its triangles equally often in both directions; triangles are
/// counter-clockwise seen from outside. Volumes are integrals of the product of both winding numbers: a region that one
/// body covers u times and the other v times is counted u v times.
struct OverlapQuery {
    using Result = Overlaps;

    /// `any`, `any_by_world`, `body_pairs` (which bodies overlap, and their relation) or `pairs` (all numbers).
    Output output = Output::pairs;
    /// Reports only pairs of bodies whose overlap has at least this volume, in magnitude and as rounded: finite, 0 or
    /// more; in cubed units of the world. 0 includes bodies that only touch.
    double min_volume = 0;
    OpenSurfaces open = OpenSurfaces::error;
    bool weld = false;  ///< merges vertices of a shape at equal positions, which closes seams, as in STL files
    /// Also makes the overlap of each body with itself, regardless of Body::self: rows (i, i), volumes of bodies, and
    /// is_solid. Always on for a single mesh.
    bool self_overlaps = false;
    bool gradient = false;  ///< also makes the derivatives of volumes by vertices
    bool curves = false;    ///< also makes the curves in which surfaces cross; not for a body with itself
    bool windings = false;  ///< also makes the winding numbers at vertices
    /// Filters of groups use the group id of each body, and are an error if a shape has groups of triangles;
    /// PairScope::within of bodies is an error, too.
    PairFilter filter = {};
};

/// Relation of two bodies, decided exactly. Volumes are integrals of winding numbers, in magnitude.
enum class OverlapRelation : std::uint8_t {
    touching,       ///< the surfaces meet, the volume of the overlap is 0
    overlapping,    ///< none of the others
    first_inside,   ///< the overlap has the volume of the first body, which is not 0
    second_inside,  ///< the overlap has the volume of the second body, which is not 0
    equal,          ///< the overlap has the volume of each of them
    undefined,      ///< a surface is not closed (OpenSurfaces::curves)
};

/// Result of an OverlapQuery: a row for each pair of bodies whose surfaces meet, or in which a component of one lies
/// inside the other. First body ≤ second body, equal only with self_overlaps. Rows are sorted by first body, then by
/// second body, so that worlds follow each other, and pairs among bodies that are in all worlds are last. Volumes, area
/// vectors, torques and areas are exact sums, rounded once; numbers derived from them are within 2 units in the last
/// place. Results are the same bytes from every backend, thread count and instruction set. A plain value: copy it to
/// keep it beyond the detector's next call.
struct Overlaps {
    bool any = false;        ///< true if there is a row
    std::int64_t count = 0;  ///< number of rows if they are listed, else 0

    Array<std::uint8_t> world_hit;  ///< per world: 1 if it has a row (not for Output::any)
    /// For OpenSurfaces::skip: bodies that are not closed, ascending, among those in selected pairs whose boxes
    /// overlap; with self_overlaps, among all bodies.
    Array<std::int32_t> skipped;

    Array<BodyPair> bodies;
    Array<OverlapRelation> relation;

    // For Output::pairs:
    /// ∫ w_first w_second dx for winding numbers w; for a body with itself ½ ∫ (w² − w) dx, the part covered twice.
    Array<double> volume;
    Array<std::array<double, 3>> centroid;  ///< centroid of the overlap; NaN if the volume is 0
    /// Derivative of the volume with respect to a translation of the first body: ∫ n dA over the part of its surface
    /// inside the second body, with outward normal n. Where surfaces coincide, the mean of both one-sided derivatives.
    /// Moving the first body along the negative vector reduces the volume fastest; the second body's vector is the
    /// negative.
    Array<std::array<double, 3>> area_vector;
    Array<std::array<double, 3>> normal;  ///< contact normal: the direction of the area vector; NaN if that vector is 0
    Array<double> mean_depth;             ///< volume divided by the length of the area vector; NaN if that vector is 0
    /// Derivative of the volume with respect to a rotation of the first body about `torque_point`: ∫ (x - p) × n dA.
    Array<std::array<double, 3>> torque;
    Array<std::array<double, 3>> torque_point;  ///< the centroid; if the volume is 0, a point between the bodies
    /// Total common area of coplanar triangles of both bodies, whichever way they face. Correctly rounded.
    Array<double> contact_area;

    /// For OverlapQuery::gradient: the derivatives of volume i by the vertices of both bodies are gradient[j], j in
    /// [gradient_offsets[i], gradient_offsets[i + 1]), sorted by body and vertex; those that are 0 are left out. Their
    /// sum over the first body is the area vector. With `weld`, the derivative for merged vertices is listed at the one
    /// with the lowest index.
    Array<std::int64_t> gradient_offsets;
    Array<BodyVertex> gradient_vertices;
    Array<std::array<double, 3>> gradient;  ///< each coordinate correctly rounded

    /// For OverlapQuery::curves: row i has the curves [curve_offsets[i], curve_offsets[i + 1]), where its surfaces
    /// cross. If you follow one on the first body, seen from outside that body, the inside of the second body is on the
    /// left. Where surfaces touch or coincide, curves are computed as if the second body were shifted by (e, e², e³), e
    /// → 0+.
    Array<std::int64_t> curve_offsets;
    /// By curve: 1 if it is closed. Open curves end at a boundary of a surface, or between adjacent triangles with
    /// opposite orientations.
    Array<std::uint8_t> curve_closed;
    /// Contribution of each curve to the area vector and the torque; NaN if it is open. Where surfaces touch or
    /// coincide, one-sided.
    Array<std::array<double, 3>> curve_area_vector, curve_torque;
    /// Curve j has the points [curve_point_offsets[j], curve_point_offsets[j + 1]); if it is closed, the last is the
    /// first. Consecutive points may be equal where a curve passes exactly through a vertex or an edge.
    Array<std::int64_t> curve_point_offsets;
    Array<std::array<double, 3>> curve_points;  ///< each coordinate correctly rounded
    /// By point: the triangles that cross between this point and the next one; −1 at the last point of a curve.
    Array<Pair> curve_triangles;

    /// For OverlapQuery::windings: the nonzero winding numbers of the other body's surface at each body's vertices,
    /// with the same layout as the gradient. At a vertex that lies on the other surface the number holds for the second
    /// body shifted by (e, e², e³), e → 0+.
    Array<std::int64_t> winding_offsets;
    Array<BodyVertex> winding_vertices;
    Array<std::int32_t> windings;

    // For OverlapQuery::self_overlaps, by body:
    Array<double> body_volume;     ///< ∫ w dx, correctly rounded; NaN for a body whose surface is not closed
    Array<std::uint8_t> is_solid;  ///< 1 if all winding numbers are 0 or 1, except in regions of volume 0

    Statistics statistics;
};

}  // namespace crumple
