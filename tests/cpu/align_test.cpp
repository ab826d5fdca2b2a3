// Tests of leaf frames from principal components and edges, and of the boxes of triangles in these frames.

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "backends/cpu/stages/align.h"
#include "geometry/edge_moment.h"
#include "tables.h"

namespace crumple::cpu {
namespace {

TEST(PrincipalAxes, axes_are_orthonormal_and_sorted_by_variance) {
    std::mt19937 engine(2);
    const auto number = [&] { return static_cast<double>(engine()) * 0x1p-31 - 1; };
    for (int round = 0; round < 1000; ++round) {
        SymmetricMatrix m;
        const double stretch[3] = {1, std::ldexp(1.0, -static_cast<int>(engine() % 30)), number() * number()};
        for (int i = 0; i < 8; ++i) {
            const Vec3d d{stretch[0] * number(), stretch[1] * number() + number() * 0.3, stretch[2] * number()};
            m.xx += d.x * d.x, m.xy += d.x * d.y, m.xz += d.x * d.z;
            m.yy += d.y * d.y, m.yz += d.y * d.z, m.zz += d.z * d.z;
        }
        const PrincipalAxes axes = principal_axes(m);
        EXPECT_GE(axes.variance[0], axes.variance[1]);
        EXPECT_GE(axes.variance[1], axes.variance[2]);
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) EXPECT_NEAR(dot(axes.axis[i], axes.axis[j]), i == j, 1e-12);
            const Vec3d e = axes.axis[i];
            const Vec3d me{m.xx * e.x + m.xy * e.y + m.xz * e.z, m.xy * e.x + m.yy * e.y + m.yz * e.z,
                           m.xz * e.x + m.yz * e.y + m.zz * e.z};
            EXPECT_NEAR(dot(me, me), axes.variance[i] * axes.variance[i], 1e-10) << "an eigenvector";
        }
    }
}

TEST(PrincipalAxes, round_cloud_gets_coordinate_axes) {
    const PrincipalAxes axes = principal_axes({1, 0.001, -0.001, 1.001, 0.0005, 0.999});
    EXPECT_EQ(axes.axis[0], (Vec3d{1, 0, 0}));
    EXPECT_EQ(axes.axis[1], (Vec3d{0, 1, 0}));
    EXPECT_EQ(axes.axis[2], (Vec3d{0, 0, 1}));
    const PrincipalAxes none = principal_axes({});
    EXPECT_EQ(none.axis[0], (Vec3d{1, 0, 0}));
}

// Returns |sin 2 phi| of an edge at the angle phi around the first axis: 0 where it is parallel to one of the other two
// axes.
double slant(const Vec3d& edge, const Vec3d& y, const Vec3d& z) {
    const double u = dot(edge, y), w = dot(edge, z);
    return std::abs(2 * u * w) / (u * u + w * w);
}

TEST(EdgeMoment, frame_aligns_with_edges_in_two_perpendicular_directions) {
    std::mt19937 engine(7);
    const auto number = [&] { return static_cast<double>(engine()) * 0x1p-31 - 1; };
    for (int round = 0; round < 1000; ++round) {
        PrincipalAxes axes = principal_axes({3, number(), number(), 2, number(), 1});
        const PrincipalAxes before = axes;
        const double angle = 4 * number(), c = std::cos(angle), s = std::sin(angle);
        const Vec3d along = c * axes.axis[1] + s * axes.axis[2], across = c * axes.axis[2] - s * axes.axis[1];
        EdgeMoment moment;
        for (int e = 0; e < 20; ++e)
            moment.add_edge(number() * (e % 3 ? along : across) + 5 * number() * axes.axis[0], axes);
        turn_to_edges(axes, moment);
        EXPECT_EQ(axes.axis[0], before.axis[0]);
        EXPECT_LT(slant(along, axes.axis[1], axes.axis[2]), 1e-9);
        EXPECT_GT(dot(axes.axis[1], before.axis[1]), 0.7) << "by 45 degrees at most";
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) EXPECT_NEAR(dot(axes.axis[i], axes.axis[j]), i == j, 1e-12);
    }
}

TEST(EdgeMoment, edges_along_the_first_axis_do_not_turn_the_frame) {
    PrincipalAxes axes = principal_axes({3, 0, 0, 2, 0, 1});
    EdgeMoment moment;
    moment.add_triangle({0, 0, 0}, {0, 0, 0}, {0.5, 0, 0}, axes);
    turn_to_edges(axes, moment);
    EXPECT_EQ(axes.axis[1], (Vec3d{0, 1, 0}));
    EXPECT_EQ(axes.axis[2], (Vec3d{0, 0, 1}));
}

TEST(LeafFrame, frame_aligns_with_perpendicular_edges_of_rotated_triangles) {
    // Long triangles with right angles, turned by some angle about x. They spread along x, and less in a direction that
    // slants to their edges, so that principal components alone do not give a frame along the edges.
    const double angle = 0.6, c = std::cos(angle), s = std::sin(angle);
    const Vec3d across{0, c, s}, upright{0, -s, c}, slanted = 0.8 * across + 0.6 * upright;
    std::mt19937 engine(8);
    const auto number = [&] { return static_cast<double>(engine()) * 0x1p-32; };
    constexpr int n = 300;
    Array<double> points;
    std::vector<std::int32_t> corners;
    Array<Ball> balls;
    LeafMembers members(nullptr);
    for (int t = 0; t < n; ++t) {
        const Vec3d p = Vec3d{0.9 * number(), 0.3, 0.3} + 0.3 * number() * slanted;
        const Vec3d corner[3] = {p, p + 0.1 * across, p + 0.002 * upright};
        for (const Vec3d& q : corner) {
            corners.push_back(static_cast<std::int32_t>(points.size() / 4));
            for (const double coordinate : {q.x, q.y, q.z, 0.0}) points.push_back(coordinate);
        }
        balls.push_back(ball_of(to_float(corner[0]), to_float(corner[1]), to_float(corner[2])));
        members.triangle.push_back(t);
        members.member.push_back(t);
    }
    const LeafFrame frame = leaf_frame(balls, {nullptr, points.data()}, corners.data(), members);
    const auto axis = [&](int i) { return Vec3d{frame.axis[i].x, frame.axis[i].y, frame.axis[i].z}; };
    EXPECT_GT(std::abs(axis(0).x), 0.99);
    EXPECT_LT(slant(across, axis(1), axis(2)), 0.1);
}

TEST(LeafRecords, boxes_and_planes_hold_their_triangles_within_rounding_bounds) {
    std::mt19937 engine(4);
    const auto number = [&] { return static_cast<float>(static_cast<double>(engine()) * 0x1p-31 - 1); };
    constexpr int n = 500;
    std::vector<double> wide;
    Array<float> points;
    std::vector<std::int32_t> corners, triangle;
    for (int v = 0; v < 3 * n; ++v) {
        for (int axis = 0; axis < 3; ++axis) points.push_back(0.5f + 0.3f * number());
        points.push_back(0);
        corners.push_back(v);
    }
    Array<double> points64;
    for (const float value : points) points64.push_back(value);
    for (int t = 0; t < n + padding; ++t) triangle.push_back(std::min(t, n - 1));

    LeafFrame frame;
    frame.origin = {0.45f, 0.55f, 0.5f};
    const PrincipalAxes axes = principal_axes({3, 0.4, 0.2, 2, -0.3, 1});
    for (int i = 0; i < 3; ++i)
        frame.axis[i] = {static_cast<float>(axes.axis[i].x), static_cast<float>(axes.axis[i].y),
                         static_cast<float>(axes.axis[i].z)};
    for (const float big : {10.0f, 0.3f}) {  // triangles with coordinates beyond `big` are "big": none, then many
        frame.big = big;
        for (const test::Tables& kernels : test::kernel_tables()) {
            for (const PointRows rows : {PointRows{points.data(), nullptr}, PointRows{nullptr, points64.data()}}) {
                Array<Record> record;
                Boxes boxes(nullptr);
                record.resize(n + padding);
                boxes.resize(n);
                LeafBounds bounds;
                kernels.intersect.build({rows, corners.data(), n, triangle.data(), n, frame}, record.data(), boxes,
                                        bounds);
                EXPECT_EQ(bounds.big > 0, big < 1) << kernels.name;
                for (int t = 0; t < n; ++t) {
                    const BoxCorner l = boxes.low[static_cast<std::size_t>(t)],
                                    h = boxes.high[static_cast<std::size_t>(t)];
                    const Vec3f low{l.x, l.y, l.z}, high{h.x, h.y, h.z};
                    for (int k = 0; k < 3; ++k) {
                        Vec3d p;
                        for (int axis = 0; axis < 3; ++axis)
                            p[axis] = static_cast<double>(points[static_cast<std::size_t>(4 * (3 * t + k) + axis)]) -
                                      static_cast<double>(frame.origin[axis]);
                        for (int axis = 0; axis < 3; ++axis) {
                            const Vec3f e = frame.axis[axis];
                            const double turned = dot(Vec3d{e.x, e.y, e.z}, p);
                            const double margin = 8 * 0x1p-24 * std::max(1.0f, bounds.reach);
                            EXPECT_LE(low[axis], turned + margin) << kernels.name;
                            EXPECT_GE(high[axis], turned - margin) << kernels.name;
                        }
                        const Record& r = record[static_cast<std::size_t>(t)];
                        EXPECT_EQ(r.id[k], corners[static_cast<std::size_t>(3 * t + k)]);
                        const double off_plane = static_cast<double>(r.x[3]) * p.x + static_cast<double>(r.y[3]) * p.y +
                                                 static_cast<double>(r.z[3]) * p.z - static_cast<double>(r.c);
                        EXPECT_LE(std::abs(off_plane), static_cast<double>(plane_bound) * 0x1p-24)
                            << kernels.name << ": the corners lie on the plane, within its bound";
                    }
                }
            }
        }
    }
}

}  // namespace
}  // namespace crumple::cpu
