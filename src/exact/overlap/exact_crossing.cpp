#include "exact/overlap/exact_crossing.h"

#include <cstddef>

namespace crumple {
namespace {

using Point = Vec3<Integer>;

int sign_of(const Integer& x) { return x.sign(); }

/// Returns the sign of v · (e, e², e³), e → 0+.
int first_sign(const Point& v) { return v.x != 0 ? sign_of(v.x) : v.y != 0 ? sign_of(v.y) : sign_of(v.z); }

/// Plane of a triangle. operator() returns the distance of a point times the length of the normal: positive on the side
/// to which the normal points.
struct DirectedPlane {
    Point normal, origin;

    explicit DirectedPlane(const IntegerTriangle& p) : normal(cross(p[1] - p[0], p[2] - p[0])), origin(p[0]) {}
    Integer operator()(const Point& p) const { return dot(normal, p - origin); }
    /// Returns the side of a point of the plane once the plane is shifted.
    int side_in_plane(Shift shift) const { return -sign_of(shift) * first_sign(normal); }
};

class IntegerSigns {
   public:
    IntegerSigns(const IntegerTriangle& a, const IntegerTriangle& b) : a_(a), b_(b), plane_a_(a), plane_b_(b) {
        has_inside_a = plane_a_.normal != Point{};
        has_inside_b = plane_b_.normal != Point{};
    }

    bool has_inside_a, has_inside_b;
    bool tied = false;

    /// Sets the direction in which b is shifted.
    void set(Shift shift) { shift_ = shift; }

    int a_side(std::size_t i) { return side(plane_b_, a_[i], shift_); }
    int b_side(std::size_t i) { return side(plane_a_, b_[i], opposite(shift_)); }
    int edges(std::size_t i, std::size_t j) {
        const int sign = sign_of(volume(i, j));
        if (sign != 0) return sign;
        tied = true;
        return sign_of(shift_) * first_sign(cross(b_[next_corner(j)] - b_[j], a_[next_corner(i)] - a_[i]));
    }

    int vertex(std::size_t of_b, std::size_t edge) const {
        const DirectedPlane& plane = of_b ? plane_a_ : plane_b_;
        const IntegerTriangle& of = of_b ? b_ : a_;
        if (plane(of[edge]) == 0) return static_cast<int>(edge);
        return plane(of[next_corner(edge)]) == 0 ? static_cast<int>(next_corner(edge)) : -1;
    }

    bool in_plane_of_b(std::size_t i) const { return plane_b_(a_[i]) == 0; }
    Integer a_distance(std::size_t i) const { return plane_b_(a_[i]); }
    Integer b_distance(std::size_t i) const { return plane_a_(b_[i]); }
    Integer volume(std::size_t i, std::size_t j) const {
        const Point& p = a_[i];
        return dot(a_[next_corner(i)] - p, cross(b_[j] - p, b_[next_corner(j)] - p));
    }

   private:
    int side(const DirectedPlane& plane, const Point& p, Shift shift) {
        const int sign = sign_of(plane(p));
        if (sign != 0) return sign;
        tied = true;
        return plane.side_in_plane(shift);
    }

    const IntegerTriangle &a_, &b_;
    DirectedPlane plane_a_, plane_b_;
    Shift shift_ = Shift::forward;
};

/// Converts points to integers in their largest common unit.
template <std::size_t N>
std::array<Vec3<Integer>, N> in_common_unit(const std::array<Vec3d, N>& points) {
    return in_units(points, common_exponent(points));
}

Rational quotient(const Integer& x, const Integer& y) { return Rational(mp::cpp_int(x)) / mp::cpp_int(y); }

}  // namespace

RationalCrossing cross_rationally(const IntegerTriangle& a, const IntegerTriangle& b, Shift shift) {
    IntegerSigns signs(a, b);
    signs.set(shift);
    RationalCrossing crossing;
    crossing.jumps = cross_faces(signs);
    if (!crossing.jumps.segment) return crossing;
    // The volume that an edge spans with an edge of the face, divided by `all`, is a barycentric coordinate of the
    // crossing in the face: that of the corner opposite this edge of the face.
    const auto edge_of_a = [&](std::size_t i) -> EdgeCrossing<Rational> {
        const Integer from = signs.a_distance(i), all = from - signs.a_distance(next_corner(i));
        return {quotient(from, all), {quotient(-signs.volume(i, 2), all), quotient(-signs.volume(i, 0), all)}};
    };
    const auto edge_of_b = [&](std::size_t i) -> EdgeCrossing<Rational> {
        const Integer from = signs.b_distance(i), all = from - signs.b_distance(next_corner(i));
        return {quotient(from, all), {quotient(-signs.volume(2, i), all), quotient(-signs.volume(0, i), all)}};
    };
    add_segment<Rational>(edge_of_a, edge_of_b, crossing);
    return crossing;
}

int winding_along_ray(const Vec3<Integer>& p, const IntegerTriangle& face, Shift shift) {
    const DirectedPlane plane(face);
    const int along = sign_of(plane.normal.x);
    if (along == 0) return 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const Point d = face[next_corner(i)] - face[i], q = p - face[i];
        int turn = sign_of(Integer(d.y * q.z - d.z * q.y));
        if (turn == 0) turn = sign_of(shift) * (d.z != 0 ? sign_of(d.z) : -sign_of(d.y));
        if (turn != along) return 0;
    }
    int side = sign_of(plane(p));
    if (side == 0) side = plane.side_in_plane(shift);
    return side == -along ? along : 0;
}

RationalCrossing cross_rationally(const FaceCorners& a, const FaceCorners& b, Shift shift) {
    const auto p = in_common_unit<6>({a[0], a[1], a[2], b[0], b[1], b[2]});
    return cross_rationally(IntegerTriangle{p[0], p[1], p[2]}, IntegerTriangle{p[3], p[4], p[5]}, shift);
}

DecidedCrossings decide_crossings(const FaceCorners& a, const FaceCorners& b) {
    const auto p = in_common_unit<6>({a[0], a[1], a[2], b[0], b[1], b[2]});
    const IntegerTriangle one{p[0], p[1], p[2]}, other{p[3], p[4], p[5]};
    IntegerSigns signs(one, other);
    return decide_crossings(signs);
}

Rational edge_parameter(const Vec3d& from, const Vec3d& to, const FaceCorners& face) {
    const auto p = in_common_unit<5>({from, to, face[0], face[1], face[2]});
    const DirectedPlane plane(IntegerTriangle{p[2], p[3], p[4]});
    const Integer at_start = plane(p[0]);
    return quotient(at_start, at_start - plane(p[1]));
}

int winding_along_ray(const Vec3d& p, const FaceCorners& face, Shift shift) {
    const auto q = in_common_unit<4>({p, face[0], face[1], face[2]});
    return winding_along_ray(q[0], IntegerTriangle{q[1], q[2], q[3]}, shift);
}

}  // namespace crumple
