#include "exact/overlap/rational_sums.h"

#include <vector>

namespace crumple {
namespace {

Vec3<Rational> rational(const Vec3<Integer>& v) {
    const auto number = [](const Integer& x) { return Rational(mp::cpp_int(x)); };
    return {number(v.x), number(v.y), number(v.z)};
}

}  // namespace

void RationalSums::add(const IntegerTriangle& face, const FaceWeights<Rational>& weights, bool of_first) {
    const Rational sum = weights[0] + weights[1] + weights[2];
    const Vec3<Rational> p0 = rational(face[0]), p1 = rational(face[1]), p2 = rational(face[2]);
    const Vec3<Rational> at = weights[0] * p0 + weights[1] * p1 + weights[2] * p2;
    const Rational cone(mp::cpp_int(dot(face[0], cross(face[1], face[2]))));
    volume += cone * sum;
    moment = moment + cone * at;
    if (!of_first) return;
    const Vec3<Rational> normal = rational(cross(face[1] - face[0], face[2] - face[0]));
    area = area + sum * normal;
    torque = torque + cross(at, normal);
}

}  // namespace crumple
