#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "crumple/array.h"
#include "crumple/intersections.h"
#include "crumple/query.h"
#include "crumple/world.h"

namespace crumple {

struct Overlaps;
struct DistributedOverlaps;

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
    using DistributedResult = DistributedOverlaps;

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
    bool extents = false;   ///< also makes boxes and thicknesses of overlaps; not for a body with itself
    /// Also makes the depths of vertices of each body inside the other one; not for a body with itself.
    bool depths = false;
    /// Above 0: also makes bounds on the greatest depth of any point, which differ by at most this, in units of length
    /// (Overlaps::depth_bound). Not for a body with itself.
    double depth_tolerance = 0;
    /// Directions along which the second body of each pair is moved away from the first one (Overlaps::withdrawals);
    /// finite, not 0, of any length.
    std::vector<std::array<double, 3>> directions = {};
    /// Also makes the first motion along each direction at which the insides of two bodies do not overlap; needs
    /// directions. Not for a body with itself.
    bool first_free = false;
    bool translation = false;  ///< also makes bounds on the least translation that separates two bodies
    /// States that all bodies are solids: their winding numbers are 0 and 1 only. Overlaps::translation_low relies on
    /// it: if it is wrong, that number may be too large. With self_overlaps it is computed instead of stated.
    bool solids = false;
    bool unions = false;   ///< also makes volumes of unions and differences; not for a body with itself
    bool regions = false;  ///< also makes the connected regions of each overlap; not for a body with itself
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

/// Part of a scene that a result of an OverlapQuery is about.
struct OverlapPart {
    /// Index and number of parts, as in Part; the number is 0 if the result is about a whole scene.
    std::int32_t index = 0, count = 0;
    bool self_overlaps = false;  ///< true if the pairs within each mesh are included
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

    /// For OverlapQuery::extents or regions: box of the overlap, rounded outwards, as x, y, z of its low and of its
    /// high corner; and its thickness, the length of the interval of normal · x over all points x of the overlap,
    /// correctly rounded. Both include parts of surfaces that enclose no volume. The box is NaN if an overlap has no
    /// extent, as for bodies that touch at a point, and for a body with itself; the thickness also if the normal is.
    Array<std::array<double, 6>> box;
    Array<double> thickness;

    /// For OverlapQuery::unions, with the volumes v = ∫ w dx of both bodies: v_first + v_second − volume, and v_first −
    /// volume and v_second − volume, each an exact sum, rounded once. For solids they are the volume of the union, and
    /// of each body without the other. intersection_over_union is volume / union_volume, within 2 units in the last
    /// place, NaN if the union has no volume. All are NaN for a body with itself, and if a surface is not closed.
    Array<double> union_volume, intersection_over_union;
    Array<std::array<double, 2>> difference_volume;

    /// For OverlapQuery::depths: the vertices of each body inside the other one, with the same layout as the gradient.
    /// The depth of a vertex is its distance to the other body's surface, correctly rounded; depth_points has the
    /// closest point of that surface, each coordinate correctly rounded, and depth_triangles its triangle, the lowest
    /// of several. A vertex is inside if the winding number there is not 0 and it does not lie on the surface.
    Array<std::int64_t> depth_offsets;
    Array<BodyVertex> depth_vertices;
    Array<double> depths;
    Array<std::array<double, 3>> depth_points;
    Array<std::int32_t> depth_triangles;
    Array<std::int64_t> deepest;  ///< by row: index of the first of its greatest depths, or −1 if it has none
    /// For OverlapQuery::depth_tolerance: bounds on the greatest depth of a row. Some point of one body's surface
    /// inside the other body has at least the depth depth_reached, and no such point is deeper than depth_bound. The
    /// bounds differ by more than the tolerance if that is below 2^-20 of the diagonal of the intersection of both
    /// bodies' boxes, or if it would take millions of steps. NaN for a body with itself, and if a surface is not
    /// closed.
    Array<double> depth_reached, depth_bound;

    /// For OverlapQuery::directions, k of them: withdrawals[k i + j] is the greatest t ≥ 0 at which the first body of
    /// row i and its second body, moved by t · directions[j], still have a common point, in units of the direction; so
    /// they are apart for every greater t. 0 if there is no such t. The least float64 that is not below it; infinity
    /// beyond the largest. NaN for a body with itself. Surfaces need not be closed.
    Array<double> withdrawals;
    /// For OverlapQuery::first_free: first_free[k i + j] is the least t ≥ 0 at which the insides of the first body of
    /// row i and of its second body, moved by t · directions[j], do not overlap: no ball is inside both. Inside means
    /// that the winding number is not 0, so a volume that is 0 because positive and negative parts cancel does not
    /// count as free. At most the withdrawal; less if the bodies touch or overlap again later. 0 if they only touch.
    /// The least float64 that is not below it; infinity beyond the largest. NaN for a body with itself, and if a
    /// surface is not closed.
    Array<double> first_free;
    /// For OverlapQuery::translation: bounds on the length of the least translation that separates two bodies. The
    /// lower one holds for every path of translations, and is NaN unless it is stated (OverlapQuery::solids) or
    /// proved that both bodies are solids. The upper one is the least withdrawal along the row's normal, its opposite
    /// and OverlapQuery::directions, and `translation` is how to move the second body for it, each coordinate rounded
    /// once; NaN if there is no such direction. All are NaN for a body with itself.
    Array<double> translation_low, translation_high;
    Array<std::array<double, 3>> translation;

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

    /// For OverlapQuery::regions: row i has the regions [region_offsets[i], region_offsets[i + 1]). A region is a
    /// connected piece of the boundary of the overlap: of the parts of both surfaces at which the other one's winding
    /// number is not 0. So volumes of regions add up to the volume of the row, and a cavity of the overlap is a region
    /// of its own with a negative volume. Numbers of a region are computed as those of a row. Where surfaces touch or
    /// coincide, regions are those for the second body shifted by (e, e², e³), e → 0+; some of them have no volume.
    /// Parts of one surface that coincide, such as a wall between two of its components, may separate or join regions.
    Array<std::int64_t> region_offsets;
    Array<double> region_volume, region_mean_depth, region_thickness;
    Array<std::array<double, 3>> region_centroid, region_area_vector, region_normal;
    Array<std::array<double, 6>> region_box;
    Array<std::uint8_t> region_is_contact;  ///< 1 if the volume is exactly 0
    /// 1 if the region may consist of several ones, because two sheets of one surface cross within it.
    Array<std::uint8_t> region_is_merged;
    /// Numbers of connected pieces of the first and of the second body's surface that form the region. If one body has
    /// two or more pieces, the other body passes through it there: a rod through a plate makes a region of one piece of
    /// the rod and two pieces of the plate. A merged region may have too few.
    Array<std::array<std::int32_t, 2>> region_pieces;
    /// By curve, for OverlapQuery::curves and regions: its region, as an index into the regions of all rows; −1 for an
    /// open row.
    Array<std::int64_t> curve_regions;

    /// For OverlapQuery::windings: the nonzero winding numbers of the other body's surface at each body's vertices,
    /// with the same layout as the gradient. At a vertex that lies on the other surface the number holds for the second
    /// body shifted by (e, e², e³), e → 0+.
    Array<std::int64_t> winding_offsets;
    Array<BodyVertex> winding_vertices;
    Array<std::int32_t> windings;

    // For OverlapQuery::self_overlaps, by body:
    Array<double> body_volume;     ///< ∫ w dx, correctly rounded; NaN for a body whose surface is not closed
    Array<std::uint8_t> is_solid;  ///< 1 if all winding numbers are 0 or 1, except in regions of volume 0

    // For a part of a scene (Detector::partition), instead of rows, which Detector::combine makes from all parts:
    OverlapPart part;  ///< the part that the result is about
    /// The pairs of triangles that intersect and that the part owns, as indices of triangles in the meshes, sorted by
    /// bodies and triangles. Bodies are the meshes, 0 and 1.
    Array<Pair> part_pairs;
    Array<BodyPair> part_bodies;  ///< by pair: the two bodies; equal for a pair within one mesh

    Statistics statistics;
};

}  // namespace crumple
