#include "exact/withdrawal/exact_withdrawal.h"

#include <cmath>
#include <cstddef>
#include <limits>

#include "exact/overlap/rational_sum.h"

namespace crumple {
namespace {

using Point = Vec3<Integer>;

/// Returns a · (b × c).
Integer determinant(const Point& a, const Point& b, const Point& c) { return dot(a, cross(b, c)); }

/// True if x / divisor lies in [0, 1]; the divisor is not 0.
bool is_in_unit_interval(const Integer& x, const Integer& divisor) {
    return divisor > 0 ? x >= 0 && x <= divisor : x <= 0 && x >= divisor;
}

int nonzero_axis(const Point& p) { return p.x != 0 ? 0 : p.y != 0 ? 1 : 2; }

/// Greatest t at which features of two triangles meet, if the second triangle is shifted by t · direction.
///
/// The pairs (x, y) of points of a and b with x − y parallel to the direction form a polytope, and t is greatest at one
/// of its vertices. A vertex is the only such pair of points of two features (vertices, edges, faces) that together
/// have at most two dimensions. So features are ignored if they have no such pair, or more than one.
class GreatestParameter {
   public:
    /// The first feature belongs to the first triangle. For the opposite case, pass the opposite direction.
    void add_vertex_and_face(const Point& p, const IntegerTriangle& face, const Point& direction);
    void add_vertex_and_edge(const Point& p, const Point& q, const Point& q_end, const Point& direction);
    void add_vertices(const Point& p, const Point& q, const Point& direction);
    void add_edges(const Point& p, const Point& p_end, const Point& q, const Point& q_end, const Point& direction);

    /// Returns the greatest t in units of 2^exponent.
    std::optional<Rational> value(int exponent) const;

   private:
    void add(Integer numerator, Integer denominator);

    Integer numerator_ = 0, denominator_ = 0;  ///< the denominator is 0 if no features meet, and otherwise positive
};

void GreatestParameter::add(Integer numerator, Integer denominator) {
    if (denominator < 0) numerator = -numerator, denominator = -denominator;
    if (denominator_ != 0 && numerator * denominator_ <= numerator_ * denominator) return;
    numerator_ = numerator;
    denominator_ = denominator;
}

void GreatestParameter::add_vertex_and_face(const Point& p, const IntegerTriangle& face, const Point& direction) {
    const Point normal = cross(face[1] - face[0], face[2] - face[0]);
    const Integer along = dot(normal, direction);
    if (along == 0) return;
    for (std::size_t k = 0; k < 3; ++k) {
        const Integer turn = determinant(direction, face[next_corner(k)] - face[k], p - face[k]);
        if (along > 0 ? turn < 0 : turn > 0) return;
    }
    add(dot(normal, p - face[0]), along);
}

void GreatestParameter::add_vertex_and_edge(const Point& p, const Point& q, const Point& q_end,
                                            const Point& direction) {
    const Point edge = q_end - q, between = p - q, normal = cross(direction, edge);
    if (normal == Point{} || dot(between, normal) != 0) return;
    const int axis = nonzero_axis(normal);
    if (is_in_unit_interval(cross(direction, between)[axis], normal[axis]))
        add(cross(between, edge)[axis], normal[axis]);
}

void GreatestParameter::add_vertices(const Point& p, const Point& q, const Point& direction) {
    const Point between = p - q;
    const int axis = nonzero_axis(direction);
    if (cross(between, direction) == Point{}) add(between[axis], direction[axis]);
}

void GreatestParameter::add_edges(const Point& p, const Point& p_end, const Point& q, const Point& q_end,
                                  const Point& direction) {
    const Point u = p_end - p, v = q_end - q, between = p - q;
    const Integer along = determinant(direction, u, v);
    if (along == 0) return;
    if (is_in_unit_interval(determinant(between, direction, v), along) &&
        is_in_unit_interval(determinant(direction, u, between), along))
        add(determinant(between, u, v), along);
}

std::optional<Rational> GreatestParameter::value(int exponent) const {
    if (denominator_ == 0) return std::nullopt;
    mp::cpp_int above(numerator_), below(denominator_);
    (exponent > 0 ? above : below) <<= std::abs(exponent);
    return Rational(above, below);
}

bool is_parallel(const IntegerTriangle& p, const Point& direction) {
    return determinant(direction, p[1] - p[0], p[2] - p[0]) == 0;
}

/// Adds the vertices of one triangle with the faces and edges of the other one.
void add_vertices(const IntegerTriangle& of, const IntegerTriangle& other, const Point& direction,
                  GreatestParameter& greatest) {
    const bool has_face = !is_parallel(other, direction);
    for (const Point& p : of) {
        // A face that is not parallel to the direction also adds what its edges would add.
        if (has_face) greatest.add_vertex_and_face(p, other, direction);
        for (std::size_t k = 0; k < 3 && !has_face; ++k)
            greatest.add_vertex_and_edge(p, other[k], other[next_corner(k)], direction);
    }
}

}  // namespace

std::optional<Rational> withdrawal_rationally(const FaceCorners& a, const FaceCorners& b, const Vec3d& direction) {
    const std::array points{a[0], a[1], a[2], b[0], b[1], b[2]};
    const int unit = common_exponent(points), unit_of_direction = common_exponent(std::array{direction});
    const IntegerTriangle p = in_units(a, unit), q = in_units(b, unit);
    const Point d = in_units(direction, unit_of_direction);
    GreatestParameter greatest;
    add_vertices(p, q, d, greatest);
    add_vertices(q, p, Point{} - d, greatest);
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) greatest.add_edges(p[i], p[next_corner(i)], q[j], q[next_corner(j)], d);
    if (is_parallel(p, d) && is_parallel(q, d))
        for (const Point& corner : p)
            for (const Point& other : q) greatest.add_vertices(corner, other, d);
    return greatest.value(unit - unit_of_direction);
}

double rounded_up(const Rational& x) {
    Cancellation none;
    RationalSum sum;
    sum.add(x);
    const double nearest = sum.rounded_quotient(1, none).value;
    if (std::isinf(nearest) || Rational(nearest) >= x) return nearest;
    return std::nextafter(nearest, std::numeric_limits<double>::infinity());
}

}  // namespace crumple
