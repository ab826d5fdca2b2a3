// What a filter calls a hit collides, and what it drops does not: each table of kernels by itself, pair by pair against
// rational arithmetic.

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "engine/cpu/sort.h"
#include "questions/intersect/cpu/records.h"
#include "questions/intersect/rational_intersection.h"
#include "tables.h"

namespace crumple::cpu {
namespace {

struct Mesh {
    std::vector<Vec3f> vertices;
    std::vector<std::int32_t> corners;

    Triangle triangle(std::size_t t) const {
        Triangle result;
        for (std::size_t k = 0; k < 3; ++k) {
            result.vertex[k] = corners[3 * t + k];
            const Vec3f p = vertices[static_cast<std::size_t>(result.vertex[k])];
            result.point[k] = {p.x, p.y, p.z};
        }
        return result;
    }
};

// Triangles over shared vertices in a slab of the given thickness: crossing, touching, folded and flat neighbours.
Mesh make_mesh(int vertices, int triangles, float thickness, bool lattice, std::mt19937& engine) {
    const auto number = [&] {
        return lattice ? static_cast<float>(engine() % 8) / 8
                       : static_cast<float>(static_cast<double>(engine()) * 0x1p-32);
    };
    Mesh mesh;
    for (int v = 0; v < vertices; ++v) mesh.vertices.push_back({number(), number(), thickness * number()});
    for (int c = 0; c < 3 * triangles; ++c)
        mesh.corners.push_back(static_cast<std::int32_t>(engine() % static_cast<unsigned>(vertices)));
    return mesh;
}

/// The exact intersections of all pairs a < b, at a * n + b.
std::vector<RationalIntersection> intersect_all(const Mesh& mesh) {
    const std::size_t n = mesh.corners.size() / 3;
    std::vector<RationalIntersection> all(n * n);
    for (std::size_t a = 0; a < n; ++a)
        for (std::size_t b = a + 1; b < n; ++b)
            all[a * n + b] = intersect_rationally(mesh.triangle(a), mesh.triangle(b));
    return all;
}

void check(const test::Tables& kernels, const Mesh& mesh, const std::vector<RationalIntersection>& exact,
           const NarrowPolicy& policy) {
    const auto n = static_cast<std::int64_t>(mesh.corners.size() / 3);
    Array<float> points;
    for (const Vec3f& p : mesh.vertices)
        for (const float value : {p.x, p.y, p.z, 0.0f}) points.push_back(value);
    points.resize(points.size() + padding);

    LeafMembers members(nullptr);
    for (std::int32_t t = 0; t < n; ++t) {
        members.triangle.push_back(t);
        members.member.push_back(t);
        members.lower.push_back(0);
    }
    for (int i = 0; i < padding; ++i) members.triangle.push_back(static_cast<std::int32_t>(n - 1));
    members.boxes.resize(static_cast<std::size_t>(n));
    LeafFrame frame;
    frame.origin = {0.5f, 0.45f, 0.01f};
    frame.axis[0] = {1, 0, 0}, frame.axis[1] = {0, 1, 0}, frame.axis[2] = {0, 0, 1};
    frame.big = 10;
    const PointRows rows{points.data(), nullptr};
    LeafRecords records(nullptr);
    records.build(kernels.intersect, {rows, mesh.corners.data(), n, members.triangle.data(), n, frame}, members);
    SortScratch scratch(nullptr);
    SortedLeaf leaf(nullptr);
    sort_leaf(members, kernels.stages, scratch, leaf);
    records.sort(kernels.intersect, leaf);

    Candidates candidates(nullptr);
    candidates.column.resize(static_cast<std::size_t>(n * n + 1000));
    candidates.row.resize(static_cast<std::size_t>(n * n + 1000));
    const std::int64_t end = kernels.stages.sweep(leaf, 0, n, n, static_cast<std::uint16_t>(n), n * n, candidates);
    ASSERT_EQ(end, n);
    Verdicts verdicts(nullptr);
    kernels.intersect.filter(records.sorted.data(), candidates, rows, policy, records.reach, verdicts);

    const auto pair_of = [&](std::uint32_t packed) {
        const auto a = static_cast<std::size_t>(leaf.link[packed & 0xffff].triangle);
        const auto b = static_cast<std::size_t>(leaf.link[packed >> 16].triangle);
        return std::pair(std::min(a, b), std::max(a, b));
    };
    std::multiset<std::pair<std::size_t, std::size_t>> hits, undecided;
    for (const std::uint32_t packed : verdicts.hit) hits.insert(pair_of(packed));
    for (const std::uint32_t packed : verdicts.undecided) undecided.insert(pair_of(packed));
    for (std::size_t a = 0; a < static_cast<std::size_t>(n); ++a)
        for (std::size_t b = a + 1; b < static_cast<std::size_t>(n); ++b) {
            const bool expected = collide(exact[a * static_cast<std::size_t>(n) + b],
                                          policy.skip_neighbours ? Neighbours::skip : Neighbours::geometric,
                                          policy.proper ? Intersections::proper : Intersections::all);
            const std::size_t hit = hits.count({a, b}), open = undecided.count({a, b});
            ASSERT_LE(hit + open, 1u) << kernels.name << ": " << a << ' ' << b << " twice";
            if (expected) {
                ASSERT_EQ(hit + open, 1u) << kernels.name << ": " << a << ' ' << b << " collide, and were dropped";
            } else {
                ASSERT_EQ(hit, 0u) << kernels.name << ": " << a << ' ' << b
                                   << " do not collide, and were called a hit, policy " << policy.skip_neighbours
                                   << policy.proper;
            }
        }
}

TEST(Verdict, no_table_drops_a_collision_or_invents_one) {
    std::mt19937 engine(31);
    for (const bool lattice : {false, true})
        for (const float thickness : {1.0f, 0.02f, 1e-6f, 0.0f})
            for (const int vertices : {8, 40, 300}) {
                const Mesh mesh = make_mesh(vertices, 70, thickness, lattice, engine);
                const auto exact = intersect_all(mesh);
                for (const test::Tables& kernels : test::kernel_tables())
                    for (const NarrowPolicy policy : {NarrowPolicy{}, {true, false}, {false, true}})
                        check(kernels, mesh, exact, policy);
            }
}

}  // namespace
}  // namespace crumple::cpu
