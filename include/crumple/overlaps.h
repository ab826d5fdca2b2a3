#pragma once

#include <array>
#include <cstdint>

#include "crumple/array.h"
#include "crumple/intersections.h"
#include "crumple/query.h"
#include "crumple/world.h"

namespace crumple {

struct Overlaps;

/// Vertex of a body, by its index in the body's shape.
struct BodyVertex {
    std::int32_t body, vertex;
    friend bool operator==(const BodyVertex&, const BodyVertex&) = default;
};

/// Query for how much closed bodies overlap, where, and which way out (docs/overlap.md). A value: it owns what it
/// names.
///
/// A surface is closed if each edge is named as often in one direction as in the other; triangles are counter-clockwise
/// seen from outside. All that is said of volumes counts by winding numbers: where two bodies pass through themselves,
/// their overlap counts as often as both cover it together.
struct OverlapQuery {
    using Result = Overlaps;

    /// `any`, `any_by_world`, `body_pairs` (which bodies overlap, and their relation) or `pairs` (all numbers).
    Output output = Output::pairs;
    /// Only pairs of bodies that overlap by at least this volume, in magnitude and as it is rounded: finite, 0 or more;
    /// in the units of the world, cubed. 0: those that touch, too.
    double min_volume = 0;
    OpenSurfaces open = OpenSurfaces::error;
    bool weld = false;  ///< vertices of a shape at equal positions are one: closes seams, as of STL files
    /// Also the overlap of each body with itself, whatever Body::self: rows (i, i), volumes of bodies, and whether they
    /// are solids. Always of a scene that is one mesh.
    bool self_overlaps = false;
    bool gradient = false;  ///< also derivatives of volumes by vertices
    bool curves = false;    ///< also the curves in which surfaces cross; not of a body with itself
    bool windings = false;  ///< also winding numbers at vertices
    /// Bodies are whole: groups of triangles (Shape::groups) are not looked at.
    PairFilter filter = {};
};

/// Relation of two bodies, decided exactly. Volumes are integrals of winding numbers, in magnitude.
enum class OverlapRelation : std::uint8_t {
    touching,       ///< the surfaces meet, the volume of the overlap is 0
    overlapping,    ///< none of the others
    first_inside,   ///< the overlap has the volume of the first body
    second_inside,  ///< the overlap has the volume of the second body
    equal,          ///< the overlap has the volume of both
    undefined,      ///< a surface is not closed (OpenSurfaces::curves)
};

/// Result of an OverlapQuery: a row for each pair of bodies whose surfaces meet, or of which one has a component inside
/// the other. First body < second body; rows in that order, so that worlds follow each other, and pairs among bodies
/// that are in all worlds are last. Volumes, area vectors, torques and areas are exact sums, rounded once; what is
/// derived of them is within 2 units in the last place. The same bytes from every backend, thread count and instruction
/// set. A plain value: copy it to keep it beyond the detector's next call.
struct Overlaps {
    bool any = false;        ///< whether there is any row
    std::int64_t count = 0;  ///< rows, where they are listed; else 0

    Array<std::uint8_t> world_hit;  ///< one a world: it has a row (not for Output::any)
    /// For OpenSurfaces::skip: the bodies whose surfaces are not closed, of those that are wanted with a body whose box
    /// overlaps theirs, ascending.
    Array<std::int32_t> skipped;

    Array<BodyPair> bodies;
    Array<OverlapRelation> relation;

    // For Output::pairs:
    /// ∫ w_first w_second dx, of winding numbers w; of a body with itself ½ ∫ (w² − w) dx, what it covers twice.
    Array<double> volume;
    Array<std::array<double, 3>> centroid;  ///< of the overlap; NaN where the volume is 0
    /// The derivative of the volume where the first body moves: ∫ n dA over what of its surface lies inside the second
    /// body, with n outwards. The mean of the limits from both sides, where surfaces lie on each other. Moved along its
    /// opposite, the first body leaves fastest; the second body has the opposite vector.
    Array<std::array<double, 3>> area_vector;
    Array<std::array<double, 3>> normal;  ///< the area vector's direction: the contact normal; NaN where it is 0
    Array<double> mean_depth;             ///< volume over the length of the area vector; NaN where that is 0
    /// The derivative of the volume where the first body turns about `torque_point`: ∫ (x - p) × n dA.
    Array<std::array<double, 3>> torque;
    Array<std::array<double, 3>> torque_point;  ///< the centroid; where there is none, a point between the bodies
    /// Area in which the surfaces coincide: what pairs of faces in one plane have in common, summed. Correctly rounded.
    Array<double> contact_area;

    /// For OverlapQuery::gradient: the derivatives of volume i by the vertices of both bodies are gradient[j], j from
    /// gradient_offsets[i] to gradient_offsets[i + 1], by body and vertex; those that are 0 are left out. Their sum
    /// over the first body is the area vector. Where a shape is welded, the lowest of equal vertices stands for all.
    Array<std::int64_t> gradient_offsets;
    Array<BodyVertex> gradient_vertices;
    Array<std::array<double, 3>> gradient;  ///< each coordinate correctly rounded

    /// For OverlapQuery::curves: the curves in which the surfaces of row i cross are those from curve_offsets[i] to
    /// curve_offsets[i + 1]. Seen on the first surface from outside, the inside of the second one is on their left.
    /// Where surfaces lie on each other they are those of the second body shifted by (e, e², e³), e → 0+.
    Array<std::int64_t> curve_offsets;
    /// By curve: 1 if it is closed. Curves end at the boundaries of open surfaces, and between triangles that are not
    /// oriented alike.
    Array<std::uint8_t> curve_closed;
    Array<std::array<double, 3>> curve_area_vector;  ///< its part of the area vector, from one side; NaN if it is open
    Array<std::array<double, 3>> curve_torque;       ///< the same of the torque
    /// Curve j has the points from curve_point_offsets[j] to curve_point_offsets[j + 1]; if it is closed, the last is
    /// the first. Points may repeat where a curve passes a vertex.
    Array<std::int64_t> curve_point_offsets;
    Array<std::array<double, 3>> curve_points;  ///< each coordinate correctly rounded
    /// By point: the triangles that cross between this point and the next one; −1 at the last point of a curve.
    Array<Pair> curve_triangles;

    /// For OverlapQuery::windings: the winding numbers of the other body's surface at the vertices of each body, in the
    /// same way. Of a vertex that lies on the other surface the number holds for the second body shifted by (e, e²,
    /// e³), e → 0+.
    Array<std::int64_t> winding_offsets;
    Array<BodyVertex> winding_vertices;
    Array<std::int32_t> windings;

    // For OverlapQuery::self_overlaps, by body:
    Array<double> body_volume;     ///< ∫ w dx, correctly rounded; NaN of a body whose surface is not closed
    Array<std::uint8_t> is_solid;  ///< 1 if all winding numbers are 0 or 1, but for regions of no volume

    Statistics statistics;
};

}  // namespace crumple
