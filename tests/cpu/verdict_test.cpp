// Tests that filters report only collisions as hits and drop only pairs that do not collide: each table of kernels (one
// for each instruction set), pair by pair, against rational arithmetic.

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "backends/cpu/intersections/intersection_records.h"
#include "backends/cpu/stages/sort.h"
#include "exact/intersection/exact_intersection.h"
#include "filters/intersection/pair_filters.h"
#include "rounds.h"
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

// Triangles over shared vertices in a slab of the given thickness: crossing, touching, folded and flat adjacent ones.
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

/// Returns the exact intersections of all pairs a < b, at a * n + b.
std::vector<RationalIntersection> intersect_all(const Mesh& mesh) {
    const std::size_t n = mesh.corners.size() / 3;
    std::vector<RationalIntersection> all(n * n);
    for (std::size_t a = 0; a < n; ++a)
        for (std::size_t b = a + 1; b < n; ++b)
            all[a * n + b] = intersect_rationally(mesh.triangle(a), mesh.triangle(b));
    return all;
}

using Pairs = std::set<std::pair<std::size_t, std::size_t>>;

/// A mesh as one leaf, and the verdicts of a table's filters for all its pairs.
struct Filtered {
    Array<float> points;
    LeafRecords records{nullptr};
    SortedLeaf leaf{nullptr};
    std::vector<std::int64_t> row;  ///< index of each triangle's record after sorting
    Pairs hits, undecided;

    Filtered(const test::Tables& kernels, const Mesh& mesh, const NarrowPolicy& policy) {
        const auto n = static_cast<std::int64_t>(mesh.corners.size() / 3);
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
        records.build(kernels.intersect, {rows(), mesh.corners.data(), n, members.triangle.data(), n, frame}, members);
        SortScratch scratch(nullptr);
        sort_leaf(members, kernels.stages, scratch, leaf);
        records.sort(kernels.intersect, leaf);
        row.assign(leaf.position.begin(), leaf.position.begin() + n);

        CandidateChunk candidates(nullptr);
        candidates.column.resize(static_cast<std::size_t>(n * n + 1000));
        candidates.row.resize(static_cast<std::size_t>(n * n + 1000));
        const std::int64_t end = kernels.stages.sweep(leaf, 0, n, n, static_cast<std::uint16_t>(n), n * n, candidates);
        EXPECT_EQ(end, n);
        Verdicts verdicts(nullptr);
        kernels.intersect.filter(records.sorted.data(), candidates, rows(), policy, records.reach, verdicts);
        for (const std::uint32_t packed : verdicts.hit) add(packed, hits, kernels.name);
        for (const std::uint32_t packed : verdicts.undecided) add(packed, undecided, kernels.name);
    }

    PointRows rows() const { return {points.data(), nullptr}; }

    /// Returns the verdict of the filters for one pair, from the same records.
    Verdict one_pair(std::size_t a, std::size_t b, const NarrowPolicy& policy) const {
        const auto first = static_cast<std::size_t>(std::min(row[a], row[b]));
        const auto second = static_cast<std::size_t>(std::max(row[a], row[b]));
        return filter_pair(records.sorted[first], records.sorted[second], policy, rows(), records.reach);
    }

   private:
    void add(std::uint32_t packed, Pairs& pairs, const char* name) {
        const auto a = static_cast<std::size_t>(leaf.link[packed & 0xffff].triangle);
        const auto b = static_cast<std::size_t>(leaf.link[packed >> 16].triangle);
        const std::pair pair(std::min(a, b), std::max(a, b));
        EXPECT_FALSE(hits.contains(pair) || undecided.contains(pair)) << name << ": " << a << ' ' << b << " twice";
        pairs.insert(pair);
    }
};

void check(const test::Tables& kernels, const Mesh& mesh, const std::vector<RationalIntersection>& exact,
           const NarrowPolicy& policy) {
    const std::size_t n = mesh.corners.size() / 3;
    const Filtered found(kernels, mesh, policy);
    for (std::size_t a = 0; a < n; ++a)
        for (std::size_t b = a + 1; b < n; ++b) {
            const bool expected =
                collide(exact[a * n + b], policy.skip_adjacent ? Neighbours::skip : Neighbours::geometric,
                        policy.proper ? IntersectionKind::proper : IntersectionKind::all);
            if (expected) {
                ASSERT_TRUE(found.hits.contains({a, b}) || found.undecided.contains({a, b}))
                    << kernels.name << ": " << a << ' ' << b << " collide, and were dropped";
            } else {
                ASSERT_FALSE(found.hits.contains({a, b}))
                    << kernels.name << ": " << a << ' ' << b << " do not collide, and were called a hit, policy "
                    << policy.skip_adjacent << policy.proper;
            }
        }
}

constexpr NarrowPolicy policies[] = {{}, {true, false}, {false, true}};

TEST(Verdict, no_filter_drops_or_invents_a_collision) {
    std::mt19937 engine(31);
    for (const bool lattice : {false, true})
        for (const float thickness : {1.0f, 0.02f, 1e-6f, 0.0f})
            for (const int vertices : {8, 40, 300}) {
                const Mesh mesh = make_mesh(vertices, 70, thickness, lattice, engine);
                const auto exact = intersect_all(mesh);
                for (const test::Tables& kernels : test::kernel_tables())
                    for (const NarrowPolicy policy : policies) check(kernels, mesh, exact, policy);
            }
}

// The SIMD filters (lanes) may round differently from the filters for one pair, so in a few cases only one of the two
// reaches a verdict. They never reach opposite verdicts.
TEST(Verdict, simd_filters_never_contradict_filters_for_one_pair) {
    std::mt19937 engine(32);
    for (const bool lattice : {false, true})
        for (const float thickness : {1.0f, 0.02f, 1e-6f, 0.0f})
            for (const int vertices : {40, 300}) {
                const Mesh mesh = make_mesh(vertices, thorough() ? 300 : 150, thickness, lattice, engine);
                const std::size_t n = mesh.corners.size() / 3;
                for (const test::Tables& kernels : test::kernel_tables())
                    for (const NarrowPolicy policy : policies) {
                        const Filtered found(kernels, mesh, policy);
                        std::int64_t differ = 0;
                        for (std::size_t a = 0; a < n; ++a)
                            for (std::size_t b = a + 1; b < n; ++b) {
                                const Verdict one = found.one_pair(a, b, policy);
                                const bool hit = found.hits.contains({a, b}),
                                           unresolved = found.undecided.contains({a, b});
                                ASSERT_FALSE(hit && one == Verdict::apart) << kernels.name << ": " << a << ' ' << b;
                                ASSERT_FALSE(!hit && !unresolved && one == Verdict::collides)
                                    << kernels.name << ": " << a << ' ' << b;
                                // A pair with disjoint boxes is neither a hit nor unresolved in `found`, since the
                                // sweep does not pass it to the filters; `one` may then be undecided.
                                if (hit != (one == Verdict::collides) || (unresolved && one != Verdict::undecided))
                                    ++differ;
                            }
                        EXPECT_LE(differ, &kernels.intersect == &scalar_intersect ? 0 : 20)
                            << kernels.name << ", " << vertices << " vertices, thickness " << thickness;
                    }
            }
}

}  // namespace
}  // namespace crumple::cpu
