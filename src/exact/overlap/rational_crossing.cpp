#include "exact/overlap/rational_crossing.h"

#include <cstddef>

namespace crumple {
namespace {

using Point = Vec3<Integer>;

constexpr std::size_t next(std::size_t i) { return (i + 1) % 3; }

int sign_of(const Integer& x) { return x.sign(); }

/// The sign of a vector times (e, e², e³), e → 0+.
int first_sign(const Point& v) { return v.x != 0 ? sign_of(v.x) : v.y != 0 ? sign_of(v.y) : sign_of(v.z); }

/// Twice the plane's distance times the normal's length: positive where the normal points to.
struct Plane {
    Point normal, origin;

    explicit Plane(const IntegerTriangle& p) : normal(cross(p[1] - p[0], p[2] - p[0])), origin(p[0]) {}
    Integer operator()(const Point& p) const { return dot(normal, p - origin); }
    /// Of a point that lies in the plane, which is shifted.
    int side_in_plane(Shift shift) const { return -sign_of(shift) * first_sign(normal); }
};

class IntegerSigns {
   public:
    IntegerSigns(const IntegerTriangle& a, const IntegerTriangle& b, Shift shift)
        : a_(a), b_(b), plane_a_(a), plane_b_(b), shift_(shift) {
        has_inside_a = plane_a_.normal != Point{};
        has_inside_b = plane_b_.normal != Point{};
    }

    bool has_inside_a, has_inside_b;

    int a_side(std::size_t i) const { return side(plane_b_, a_[i], shift_); }
    int b_side(std::size_t i) const { return side(plane_a_, b_[i], opposite(shift_)); }
    int edges(std::size_t i, std::size_t j) const {
        const int sign = sign_of(volume(i, j));
        return sign != 0 ? sign : sign_of(shift_) * first_sign(cross(b_[next(j)] - b_[j], a_[next(i)] - a_[i]));
    }

    Integer a_distance(std::size_t i) const { return plane_b_(a_[i]); }
    Integer b_distance(std::size_t i) const { return plane_a_(b_[i]); }
    Integer volume(std::size_t i, std::size_t j) const {
        const Point& p = a_[i];
        return dot(a_[next(i)] - p, cross(b_[j] - p, b_[next(j)] - p));
    }

   private:
    static int side(const Plane& plane, const Point& p, Shift shift) {
        const int sign = sign_of(plane(p));
        return sign != 0 ? sign : plane.side_in_plane(shift);
    }

    const IntegerTriangle &a_, &b_;
    Plane plane_a_, plane_b_;
    Shift shift_;
};

Rational quotient(const Integer& x, const Integer& y) { return Rational(mp::cpp_int(x)) / mp::cpp_int(y); }

std::array<Rational, 3> on_edge(std::size_t i, const Integer& from, const Integer& to) {
    const Rational t = quotient(from, from - to);
    std::array<Rational, 3> at{};
    at[i] = 1 - t;
    at[next(i)] = t;
    return at;
}

/// From the volumes with edges 01, 12, 20, each of which is that of the corner opposite.
std::array<Rational, 3> in_face(const std::array<Integer, 3>& volume) {
    const Integer sum = volume[0] + volume[1] + volume[2];
    return {quotient(volume[1], sum), quotient(volume[2], sum), quotient(volume[0], sum)};
}

/// Adds `times` a triangle [p0, x, y] of the chain, p0 being the first corner: its share of the face's area at each of
/// its corners.
void add(const std::array<Rational, 3>& x, const std::array<Rational, 3>& y, int times, RationalWeights& weights) {
    const Rational share = Rational(times) * (x[1] * y[2] - x[2] * y[1]);
    weights[0] += share * (1 + x[0] + y[0]);
    weights[1] += share * (x[1] + y[1]);
    weights[2] += share * (x[2] + y[2]);
}

}  // namespace

// The winding number on a face is the sum of cones from its first corner: over what is left of edges 01 and 12 behind
// each crossing, and over each segment (docs/overlap.md).
RationalCrossing cross_rationally(const IntegerTriangle& a, const IntegerTriangle& b, Shift shift) {
    const IntegerSigns signs(a, b, shift);
    RationalCrossing crossing;
    crossing.jumps = cross_faces(signs);
    if (!crossing.jumps.segment) return crossing;
    const std::array<Rational, 3> corner1{0, 1, 0}, corner2{0, 0, 1};
    for (std::size_t i = 0; i < 3; ++i) {
        if (const int jump = crossing.jumps.a[i]) {
            const CrossingPoint at{on_edge(i, signs.a_distance(i), signs.a_distance(next(i))),
                                   in_face({signs.volume(i, 0), signs.volume(i, 1), signs.volume(i, 2)})};
            (jump > 0 ? crossing.end : crossing.start) = at;
            if (i == 0) add(corner1, corner2, jump, crossing.a);
            if (i == 1) add(at.in_a, corner2, jump, crossing.a);
        }
        if (const int jump = crossing.jumps.b[i]) {
            const CrossingPoint at{in_face({signs.volume(0, i), signs.volume(1, i), signs.volume(2, i)}),
                                   on_edge(i, signs.b_distance(i), signs.b_distance(next(i)))};
            (jump > 0 ? crossing.start : crossing.end) = at;
            if (i == 0) add(corner1, corner2, jump, crossing.b);
            if (i == 1) add(at.in_b, corner2, jump, crossing.b);
        }
    }
    add(crossing.start.in_a, crossing.end.in_a, 1, crossing.a);
    add(crossing.end.in_b, crossing.start.in_b, 1, crossing.b);
    return crossing;
}

int winding_along_ray(const Vec3<Integer>& p, const IntegerTriangle& face, Shift shift) {
    const Plane plane(face);
    const int along = sign_of(plane.normal.x);
    if (along == 0) return 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const Point d = face[next(i)] - face[i], q = p - face[i];
        int turn = sign_of(Integer(d.y * q.z - d.z * q.y));
        if (turn == 0) turn = sign_of(shift) * (d.z != 0 ? sign_of(d.z) : -sign_of(d.y));
        if (turn != along) return 0;
    }
    int side = sign_of(plane(p));
    if (side == 0) side = plane.side_in_plane(shift);
    return side == -along ? along : 0;
}

}  // namespace crumple
