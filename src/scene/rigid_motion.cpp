#include "crumple/rigid_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "base/float_environment.h"
#include "crumple/error.h"
#include "geometry/vec.h"

namespace crumple {
namespace {

constexpr double most_pieces = 1 << 20;

using Rotation = std::array<Vec3d, 3>;  // by rows

Rotation rotation_of(const Pose& pose) {
    const auto row = [&](std::size_t i) { return Vec3d{pose.rows[4 * i], pose.rows[4 * i + 1], pose.rows[4 * i + 2]}; };
    return {row(0), row(1), row(2)};
}

Vec3d translation_of(const Pose& pose) { return {pose.rows[3], pose.rows[7], pose.rows[11]}; }

bool is_rigid(const Pose& pose) {
    constexpr double most_off = 1e-9;
    const Rotation r = rotation_of(pose);
    const auto off = [](double x) { return !(std::abs(x) <= most_off); };
    for (std::size_t i = 0; i < 3; ++i)
        if (off(dot(r[i], r[i]) - 1) || off(dot(r[i], r[(i + 1) % 3]))) return false;
    return dot(cross(r[0], r[1]), r[2]) > 0 && all_finite(translation_of(pose));
}

[[noreturn]] void refuse_body(std::size_t body, const char* what) {
    throw Error(ErrorCode::invalid_argument, "body " + std::to_string(body) + ": " + what, Element::body,
                static_cast<std::int64_t>(body));
}

/// A rotation by an angle in [0, pi] about an axis of length 1.
struct Turn {
    Vec3d axis{1, 0, 0};
    double angle = 0;

    /// Returns `r`, turned by the given fraction of the angle.
    Rotation operator()(const Rotation& r, double share) const {
        const double c = std::cos(share * angle), s = std::sin(share * angle);
        Rotation turned;
        for (int column = 0; column < 3; ++column) {
            const Vec3d v{r[0][column], r[1][column], r[2][column]};
            const Vec3d w = c * v + s * cross(axis, v) + ((1 - c) * dot(axis, v)) * axis;
            for (int row = 0; row < 3; ++row) turned[static_cast<std::size_t>(row)][column] = w[row];
        }
        return turned;
    }
};

/// Returns the rotation from one pose to another, from the quaternion's largest component.
Turn turn_between(const Pose& start, const Pose& end) {
    const Rotation a = rotation_of(start), b = rotation_of(end);
    // Returns entry (i, k) of b times the transpose of a.
    const auto m = [&](std::size_t i, std::size_t k) { return dot(b[i], a[k]); };
    const double trace = m(0, 0) + m(1, 1) + m(2, 2);
    const std::array<double, 4> squares{1 + 2 * m(0, 0) - trace, 1 + 2 * m(1, 1) - trace, 1 + 2 * m(2, 2) - trace,
                                        1 + trace};
    const auto largest = static_cast<std::size_t>(std::max_element(squares.begin(), squares.end()) - squares.begin());
    Vec3d v;
    double w = 0;
    if (largest == 3) {
        v = {m(2, 1) - m(1, 2), m(0, 2) - m(2, 0), m(1, 0) - m(0, 1)};
        w = squares[3];
    } else {
        const std::size_t i = largest, j = (i + 1) % 3, k = (i + 2) % 3;
        v[static_cast<int>(i)] = squares[i];
        v[static_cast<int>(j)] = m(i, j) + m(j, i);
        v[static_cast<int>(k)] = m(i, k) + m(k, i);
        w = m(k, j) - m(j, k);
    }
    if (w < 0) v = Vec3d{} - v, w = -w;
    const double length = std::sqrt(dot(v, v));
    if (!(length > 0)) return {};
    return {(1 / length) * v, 2 * std::atan2(length, w)};
}

/// Returns a bound on the distance between an arc and its chord at equal parameters: r (1 - cos(angle / 2)).
double off_chord(double radius, double angle) {
    const double s = std::sin(angle / 4);
    return 2 * radius * s * s;
}

}  // namespace

RigidMotion cut_rigid_motion(std::span<const Pose> start, std::span<const Pose> end, std::span<const double> radii,
                             double tolerance) {
    const FloatEnvironment environment;
    const std::size_t bodies = start.size();
    if (end.size() != bodies || radii.size() != bodies)
        throw Error(ErrorCode::invalid_argument, "start, end and radii must have the same length", Element::option);
    if (!(tolerance > 0) || !std::isfinite(tolerance))
        throw Error(ErrorCode::invalid_argument, "tolerance must be finite and above 0", Element::option);
    std::vector<Turn> turns(bodies);
    double pieces = 1, size = 0;
    for (std::size_t b = 0; b < bodies; ++b) {
        if (!is_rigid(start[b])) refuse_body(b, "its pose at the start is not a rotation with a translation");
        if (!is_rigid(end[b])) refuse_body(b, "its pose at the end is not a rotation with a translation");
        if (!(radii[b] >= 0) || !std::isfinite(radii[b])) refuse_body(b, "its radius must be finite and 0 or more");
        turns[b] = turn_between(start[b], end[b]);
        size = std::max(size, radii[b] + largest(abs(translation_of(start[b]))) + largest(abs(translation_of(end[b]))));
        // The tolerance is for a pair of bodies, so each body gets half of it.
        const double most = 4 * std::asin(std::sqrt(std::min(0.5, tolerance / (4 * radii[b]))));
        if (turns[b].angle > 0) pieces = std::max(pieces, std::ceil(turns[b].angle / most));
    }
    if (!(pieces <= most_pieces))
        throw Error(ErrorCode::invalid_argument, "tolerance is too small: it needs more than 1,048,576 pieces",
                    Element::option);

    RigidMotion motion;
    motion.pieces = static_cast<std::int64_t>(pieces);
    motion.poses.assign(start.begin(), start.end());
    for (std::int64_t k = 1; k < motion.pieces; ++k) {
        const double share = static_cast<double>(k) / pieces;
        for (std::size_t b = 0; b < bodies; ++b) {
            const Rotation r = turns[b](rotation_of(start[b]), share);
            const Vec3d t = (1 - share) * translation_of(start[b]) + share * translation_of(end[b]);
            motion.poses.push_back(
                {{r[0].x, r[0].y, r[0].z, t.x, r[1].x, r[1].y, r[1].z, t.y, r[2].x, r[2].y, r[2].z, t.z}});
        }
    }
    motion.poses.insert(motion.poses.end(), end.begin(), end.end());
    for (std::size_t b = 0; b < bodies; ++b) {
        // The given matrices are not exact rotations, so rotating the start pose by the whole angle need not give the
        // end pose exactly.
        const Rotation turned = turns[b](rotation_of(start[b]), 1), given = rotation_of(end[b]);
        double off = 0;
        for (std::size_t row = 0; row < 3; ++row) off = std::max(off, largest(abs(turned[row] - given[row])));
        motion.min_distance =
            std::max(motion.min_distance, off_chord(radii[b], turns[b].angle / pieces) + 3 * off * radii[b]);
    }
    motion.min_distance = 2 * motion.min_distance + 0x1p-46 * size;  // covers a few roundings of the poses
    return motion;
}

}  // namespace crumple
