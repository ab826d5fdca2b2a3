// Tests of rigid motions cut into pieces: distance of vertices from the straight pieces, and a contact that one piece
// misses.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "crumple/crumple.h"
#include "error_of.h"
#include "worlds/random_worlds.h"

namespace crumple::test {
namespace {

using Point = std::array<double, 3>;

Point posed(const Pose& pose, const Point& p) {
    Point q;
    for (std::size_t i = 0; i < 3; ++i)
        q[i] =
            pose.rows[4 * i] * p[0] + pose.rows[4 * i + 1] * p[1] + pose.rows[4 * i + 2] * p[2] + pose.rows[4 * i + 3];
    return q;
}
double distance(const Point& p, const Point& q) { return std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]); }
Point between(const Point& p, const Point& q, double t) {
    return {(1 - t) * p[0] + t * q[0], (1 - t) * p[1] + t * q[1], (1 - t) * p[2] + t * q[2]};
}

Pose turned_about_z(double angle, double x = 0) {
    const double c = std::cos(angle), s = std::sin(angle);
    return {{c, -s, 0, x, s, c, 0, 0, 0, 0, 1, 0}};
}

Pose random_rigid(Dice& dice) {
    double q[4], length = 0;
    for (double& c : q) c = dice.between(-1, 1), length += c * c;
    for (double& c : q) c /= std::sqrt(length);
    const auto [w, x, y, z] = q;
    return {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), dice.between(-2, 2),
             2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x), dice.between(-2, 2),
             2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y), dice.between(-2, 2)}};
}

/// Compares with a motion of at least 16 times as many pieces, in place of the true motion.
TEST(RigidMotions, vertices_stay_within_the_promised_distance_of_pieces) {
    Dice dice(5);
    double worst = 0;
    for (int i = 0; i < 60; ++i) {
        const std::vector<Pose> start{random_rigid(dice)}, end{random_rigid(dice)};
        const std::vector<double> radii{1.5};
        const double tolerance = std::array{1.0, 0.1, 0.01}[static_cast<std::size_t>(i % 3)];
        const RigidMotion coarse = cut_rigid_motion(start, end, radii, tolerance);
        EXPECT_LE(coarse.min_distance, tolerance * (1 + 1e-6) + 1e-9);
        EXPECT_EQ(coarse.at(0)[0], start[0]);
        EXPECT_EQ(coarse.at(coarse.pieces)[0], end[0]);
        RigidMotion fine = coarse;
        for (double finer = tolerance; fine.pieces % coarse.pieces != 0 || fine.pieces < 16 * coarse.pieces;
             finer /= 1.1)
            fine = cut_rigid_motion(start, end, radii, finer);
        const Point p{1.5 * std::cos(i), 1.5 * std::sin(i), 0};
        const std::int64_t steps = fine.pieces / coarse.pieces;
        for (std::int64_t k = 0; k < fine.pieces; ++k) {
            const double t = static_cast<double>(k % steps) / static_cast<double>(steps);
            const Point straight = between(posed(coarse.at(k / steps)[0], p), posed(coarse.at(k / steps + 1)[0], p), t);
            const double off = distance(posed(fine.at(k)[0], p), straight);
            EXPECT_LE(off, coarse.min_distance / 2);
            worst = std::max(worst, off / (coarse.min_distance / 2));
        }
    }
    EXPECT_GT(worst, 0.9) << "the bound is far too large";
}

/// A bar that makes half a turn passes a pole with its side; straight trajectories lead through its centre instead.
TEST(RigidMotions, pieces_find_contacts_that_straight_motion_misses) {
    const std::vector<Point> bar{{-2, 0, -0.1}, {2, 0, -0.1}, {2, 0, 0.1}},
        pole{{0, 1.5, -1}, {0, 1.5, 1}, {0.01, 1.6, 1}};
    const std::vector<std::array<std::int32_t, 3>> one{{0, 1, 2}};
    const std::vector<Shape> shapes{Shape(MeshView(bar, one)), Shape(MeshView(pole, one))};
    const std::vector<Body> bodies{{.shape = 0}, {.shape = 1}};
    const std::vector<Pose> start{turned_about_z(0), Pose()}, end{turned_about_z(std::numbers::pi), Pose()};
    const std::vector<double> radii{2.01, 2};
    Detector detector;
    EXPECT_FALSE(detector.any(World{shapes, bodies, start, end}, ImpactQuery()));
    for (const double tolerance : {0.3, 0.01}) {
        const RigidMotion motion = cut_rigid_motion(start, end, radii, tolerance);
        double contact = 2;
        for (std::int64_t k = 0; k < motion.pieces && contact > 1; ++k) {
            const FirstImpact& first = detector.find(World{shapes, bodies, motion.at(k), motion.at(k + 1)},
                                                     FirstImpactQuery{{.min_distance = motion.min_distance}});
            if (first.found) contact = (static_cast<double>(k) + first.toi) / static_cast<double>(motion.pieces);
        }
        EXPECT_LE(contact, 0.5) << "the bar stands upright then";
        EXPECT_GT(contact, 0.5 - tolerance);
    }
}

TEST(RigidMotions, motion_without_rotation_is_one_piece) {
    const std::vector<Pose> start{turned_about_z(1), turned_about_z(0)}, end{turned_about_z(1, 5), turned_about_z(0)};
    const RigidMotion motion = cut_rigid_motion(start, end, std::vector<double>{100, 0}, 1e-9);
    EXPECT_EQ(motion.pieces, 1);
    EXPECT_EQ(motion.poses.size(), 4u);
    EXPECT_LT(motion.min_distance, 1e-9);
    EXPECT_EQ(cut_rigid_motion({}, {}, {}, 1).pieces, 1);
    // Half a turn about each axis.
    for (std::size_t axis = 0; axis < 3; ++axis) {
        Pose half;
        for (std::size_t i = 0; i < 3; ++i) half.rows[5 * i] = i == axis ? 1 : -1;
        const RigidMotion turn = cut_rigid_motion(std::vector<Pose>(1), std::vector{half}, std::vector{1.0}, 0.1);
        EXPECT_EQ(turn.pieces, 5);
        EXPECT_LT(turn.min_distance, 0.1 + 1e-12);
    }
}

TEST(RigidMotions, motions_that_are_not_rigid_are_rejected) {
    const auto message = [](Pose start, Pose end, double radius, double tolerance) {
        return std::string(error_of([&] {
                               cut_rigid_motion(std::vector{start}, std::vector{end}, std::vector{radius}, tolerance);
                           }).what());
    };
    Pose scaled, reflected;
    scaled.rows[0] = 1.1;
    reflected.rows[0] = -1;
    EXPECT_EQ(message(scaled, {}, 1, 1), "body 0: its pose at the start is not a rotation with a translation");
    EXPECT_EQ(message({}, reflected, 1, 1), "body 0: its pose at the end is not a rotation with a translation");
    EXPECT_EQ(message({}, {}, -1, 1), "body 0: its radius must be finite and 0 or more");
    EXPECT_EQ(message({}, {}, 1, 0), "tolerance must be finite and above 0");
    EXPECT_EQ(message({}, turned_about_z(1), 1, 1e-15), "tolerance is too small: it needs more than 1,048,576 pieces");
    EXPECT_EQ(
        std::string(error_of([&] { cut_rigid_motion(std::vector<Pose>(2), std::vector<Pose>(1), {}, 1); }).what()),
        "start, end and radii must have the same length");
}

}  // namespace
}  // namespace crumple::test
