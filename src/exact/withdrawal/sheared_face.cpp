#include "exact/withdrawal/sheared_face.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace crumple {
namespace {

Rational power_of_two(int exponent) {
    const mp::cpp_int power = mp::cpp_int(1) << std::abs(exponent);
    return exponent < 0 ? Rational(1, power) : Rational(power);
}

/// Returns the bytes of the digits of a number. Few digits are stored in the number itself, and are counted twice.
std::size_t bytes_of_limbs(const Rational& x) {
    const auto limbs = [](const mp::cpp_int& n) { return n.backend().size() * sizeof(mp::limb_type); };
    return limbs(numerator(x)) + limbs(denominator(x));
}

using IntegerPoint = Vec3<Integer>;

Rational share_of(const Integer& x, const Integer& divisor) {
    return Rational(mp::cpp_int(divisor < 0 ? -x : x), mp::cpp_int(divisor < 0 ? -divisor : divisor));
}

/// Edge of a face, from a corner to the next one, of which parts are cut off. Coordinates are integers.
class CutEdge {
   public:
    CutEdge(const IntegerPoint& from, const IntegerPoint& to) : from_(from), to_(to) {}

    bool is_empty() const { return is_empty_; }
    /// Keeps the part in the plane through `at`.
    void keep_in_plane(const IntegerPoint& normal, const IntegerPoint& at) {
        const Integer start = dot(normal, from_ - at), end = dot(normal, to_ - at);
        is_empty_ = is_empty_ || (start > 0 && end > 0) || (start < 0 && end < 0);
        if (is_empty_ || start == end) return;
        const Rational share = share_of(start, start - end);
        cut(share, share);
    }
    /// Keeps the part in the half-space into which the normal points.
    void keep_above(const IntegerPoint& normal, const IntegerPoint& at) {
        const Integer start = dot(normal, from_ - at), end = dot(normal, to_ - at);
        is_empty_ = is_empty_ || (start < 0 && end < 0);
        if (is_empty_ || (start >= 0 && end >= 0)) return;
        const Rational share = share_of(start, start - end);
        start < 0 ? cut(share, 1) : cut(0, share);
    }
    void add_ends(PlaceSet& places) const {
        if (is_empty_) return;
        const auto rational = [](const Integer& x) { return Rational(mp::cpp_int(x)); };
        const ShearedPlace from{rational(from_.x), rational(from_.y)}, to{rational(to_.x), rational(to_.y)};
        for (const Rational& s : {low_, high_}) places.insert(s == 0 ? from : s == 1 ? to : from + s * (to - from));
    }

   private:
    /// Keeps the part between two shares of the edge.
    void cut(const Rational& low, const Rational& high) {
        if (low > low_) low_ = low;
        if (high < high_) high_ = high;
        is_empty_ = low_ > high_;
    }

    const IntegerPoint &from_, &to_;
    Rational low_ = 0, high_ = 1;
    bool is_empty_ = false;
};

/// Face whose heights are multiplied by a common denominator of both faces.
struct IntegerFace {
    std::array<IntegerPoint, 3> corner;
    IntegerPoint normal;

    IntegerFace(const ShearedFace& face, const Integer& denominator, const Integer& lift) {
        for (std::size_t k = 0; k < 3; ++k) {
            const auto integer = [](const Rational& x) { return Integer(mp::cpp_int(numerator(x))); };
            const ShearedPoint& p = face.corner(k);
            corner[k] = {integer(p.x), integer(p.y), integer(p.z) * denominator + lift};
        }
        normal = cross(corner[1] - corner[0], corner[2] - corner[0]);
    }
};

void add_edges_within(const IntegerFace& of, const IntegerFace& face, PlaceSet& places) {
    for (std::size_t k = 0; k < 3; ++k) {
        CutEdge edge(of.corner[k], of.corner[(k + 1) % 3]);
        edge.keep_in_plane(face.normal, face.corner[0]);
        for (std::size_t j = 0; j < 3 && !edge.is_empty(); ++j)
            edge.keep_above(cross(face.normal, face.corner[(j + 1) % 3] - face.corner[j]), face.corner[j]);
        edge.add_ends(places);
    }
}

}  // namespace

Shear::Shear(const Vec3d& direction, int axis, int unit) : axis_(axis), exponent_(unit), unit_(power_of_two(unit)) {
    const int unit_of_direction = common_exponent(std::array{direction});
    direction_ = in_units(direction, unit_of_direction);
    const Integer length = direction_[axis] < 0 ? -direction_[axis] : direction_[axis];
    step_ = Rational(mp::cpp_int(length)) * power_of_two(unit_of_direction) / unit_;
}

ShearedPoint Shear::operator()(const Vec3d& p) const {
    const Vec3<Integer> at = in_units(p, exponent_);
    const bool up = direction_[axis_] > 0;
    const auto across = [&](int other) {
        const Integer x = at[other] * direction_[axis_] - at[axis_] * direction_[other];
        return Rational(mp::cpp_int(up ? x : -x));
    };
    return {across((axis_ + 1) % 3), across((axis_ + 2) % 3), Rational(mp::cpp_int(up ? at[axis_] : -at[axis_]))};
}

ShearedPlace Shear::coordinates_of(const ShearedPlace& place) const {
    const Integer& along = direction_[axis_];
    const Rational unit = unit_ / Rational(mp::cpp_int(along < 0 ? -along : along));
    return unit * place;
}

std::size_t bytes_of(const ShearedPlace& place) {
    return sizeof(ShearedPlace) + bytes_of_limbs(place.u) + bytes_of_limbs(place.v);
}

std::size_t ShearedFace::bytes() const {
    std::size_t bytes = sizeof(ShearedFace);
    for (const ShearedPoint* p : {&corner_[0], &corner_[1], &corner_[2], &normal_})
        bytes += bytes_of_limbs(p->x) + bytes_of_limbs(p->y) + bytes_of_limbs(p->z);
    return bytes;
}

ShearedFace::ShearedFace(const FaceCorners& corners, const Shear& shear, std::int32_t index)
    : corner_{shear(corners[0]), shear(corners[1]), shear(corners[2])},
      normal_(cross(corner_[1] - corner_[0], corner_[2] - corner_[0])),
      index_(index) {}

int ShearedFace::position(const ShearedPlace& p) const { return std::min({side(0, p), side(1, p), side(2, p)}); }

Rational ShearedFace::height(const ShearedPlace& p) const { return corner_[0].z + slope(p - place(0)); }

void add_contact_places(const ShearedFace& a, const ShearedFace& b, const Rational& lift, PlaceSet& places) {
    if (a.is_degenerate() || b.is_degenerate()) return;
    const Integer divisor(mp::cpp_int(denominator(lift)));
    const IntegerFace p(a, divisor, 0), q(b, divisor, Integer(mp::cpp_int(numerator(lift))));
    add_edges_within(p, q, places);
    add_edges_within(q, p, places);
}

PlacePolygon::PlacePolygon(const ShearedFace& a, const ShearedFace& b) {
    for (std::size_t k = 0; k < 3; ++k) corners_.push_back(a.place(a.jump() > 0 ? k : 2 - k));
    for (std::size_t k = 0; k < 3; ++k) cut(b.place(k), Rational(b.jump()) * b.edge(k));
}

ShearedPlace PlacePolygon::middle() const {
    ShearedPlace sum{0, 0};
    for (const ShearedPlace& p : corners_) sum = sum + p;
    return Rational(1, static_cast<int>(corners_.size())) * sum;
}

void PlacePolygon::cut(const ShearedPlace& p, const ShearedPlace& w) {
    std::vector<Rational> side;
    bool any_left = false, any_right = false;
    for (const ShearedPlace& corner : corners_) {
        side.push_back(cross(w, corner - p));
        any_left = any_left || side.back() > 0;
        any_right = any_right || side.back() < 0;
    }
    if (!any_right) return;
    std::vector<ShearedPlace> left;
    for (std::size_t k = 0; k < corners_.size() && any_left; ++k) {
        const std::size_t next = k + 1 == corners_.size() ? 0 : k + 1;
        if (side[k] >= 0) left.push_back(corners_[k]);
        if ((side[k] > 0 && side[next] < 0) || (side[k] < 0 && side[next] > 0)) {
            const Rational share = side[k] / (side[k] - side[next]);
            left.push_back(corners_[k] + share * (corners_[next] - corners_[k]));
        }
    }
    corners_ = std::move(left);
}

std::pair<Rational, Rational> PlacePolygon::lifts(const ShearedFace& a, const ShearedFace& b) const {
    std::pair<Rational, Rational> range;
    for (std::size_t k = 0; k < corners_.size(); ++k) {
        const Rational lift = a.height(corners_[k]) - b.height(corners_[k]);
        if (k == 0 || lift < range.first) range.first = lift;
        if (k == 0 || lift > range.second) range.second = lift;
    }
    return range;
}

}  // namespace crumple
