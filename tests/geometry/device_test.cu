// Runs decisions, contacts, filters and the assignment of triangles to parts as device code, on a device or on the CPU,
// and compares them with the host.

#include <cstring>

#include "cuda_on_cpu/tests/portable/portable.h"
#include "exact/intersection/contact_on_line.h"
#include "exact/intersection/decide_intersection.h"
#include "exact/intersection/intersection_decision.h"
#include "filters/intersection/pair_filters.h"
#include "geometry/ball.h"
#include "geometry/random_pairs.h"
#include "partition/part_tree.h"

namespace crumple {
namespace {

class Device : public portable::DeviceTest {};

template <class Signs>
__global__ void decide_all(const TrianglePair* pairs, int count, Neighbours neighbours, IntersectionKind intersections,
                           Verdict* verdicts) {
    const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
    if (i >= count) return;
    Signs signs;
    verdicts[i] = decide(pairs[i].a, pairs[i].b, neighbours, intersections, signs);
}

template <class Signs>
std::vector<Verdict> decide_on_device(const std::vector<TrianglePair>& pairs, IntersectionKind intersections) {
    const portable::Array<TrianglePair> input(pairs);
    const portable::Array<Verdict> output(pairs.size());
    const auto blocks = static_cast<unsigned>((pairs.size() + 127) / 128);
    portable::launch(&decide_all<Signs>, blocks, 128, 0, input.data(), static_cast<int>(pairs.size()),
                     Neighbours::geometric, intersections, output.data());
    return output.values();
}

const int rounds = scaled_rounds(4'000);

TEST_F(Device, decisions_match_the_host) {
    for (const Kind kind : all_kinds) {
        RandomPairs random(kind, 47);
        std::vector<TrianglePair> pairs;
        for (int i = 0; i < rounds; ++i) pairs.push_back(random());
        for (const IntersectionKind intersections : {IntersectionKind::all, IntersectionKind::proper}) {
            const auto filtered = decide_on_device<FilteredSigns>(pairs, intersections);
            const auto exact = decide_on_device<ExactSigns>(pairs, intersections);
            for (std::size_t i = 0; i < pairs.size(); ++i) {
                DecisionCounts counts;
                const bool collides = collide(pairs[i].a, pairs[i].b, Neighbours::geometric, intersections, counts);
                const Verdict expected = collides ? Verdict::collides : Verdict::apart;
                ASSERT_EQ(exact[i], counts.rational ? Verdict::undecided : expected) << pairs[i];
                if (filtered[i] != Verdict::undecided) {
                    ASSERT_EQ(filtered[i], expected) << pairs[i];
                }
            }
        }
    }
}

struct Found {
    bool done;
    Contact contact;
};

__global__ void contact_all(const TrianglePair* pairs, int count, Found* found) {
    const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
    if (i < count) found[i].done = contact_on_line(pairs[i].a, pairs[i].b, NothingExact{}, found[i].contact);
}

TEST_F(Device, contacts_that_the_device_computes_match_the_host) {
    for (const Kind kind : all_kinds) {
        RandomPairs random(kind, 79);
        std::vector<TrianglePair> pairs;
        for (int i = 0; i < rounds; ++i) pairs.push_back(random());
        const portable::Array<TrianglePair> input(pairs);
        const portable::Array<Found> output(pairs.size());
        portable::launch(contact_all, static_cast<unsigned>((pairs.size() + 127) / 128), 128, 0, input.data(),
                         static_cast<int>(pairs.size()), output.data());
        const std::vector<Found> found = output.values();
        int done = 0;
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            if (!found[i].done) continue;
            ++done;
            const Contact expected = contact(pairs[i].a, pairs[i].b);
            ASSERT_EQ(found[i].contact.count, expected.count) << pairs[i];
            ASSERT_EQ(std::memcmp(found[i].contact.points.data(), expected.points.data(),
                                  static_cast<std::size_t>(expected.count) * sizeof(Vec3d)),
                      0)
                << pairs[i];
        }
        if (kind == Kind::random || kind == Kind::random_float) {
            EXPECT_GT(done, rounds / 4 * 3);
        }
    }
}

/// Two members of one leaf, each with its vertices in rows of its own.
struct Leaf {
    float rows[24];
    std::int32_t id[6];
    LeafFrame frame;
};
struct FilterResult {
    Verdict verdict;
    Ball ball;
    bool joins;
};

CRUMPLE_HD FilterResult filter_result(const Leaf& leaf) {
    const PointRows points{leaf.rows, nullptr};
    const auto corners = [&](int t, Vec3d p[3]) {
        for (int k = 0; k < 3; ++k) p[k] = points[leaf.id[3 * t + k]];
    };
    Vec3d p[3], q[3];
    corners(0, p);
    corners(1, q);
    const InFrame<3> a(p, leaf.frame), b(q, leaf.frame);
    Record first = record_of(p, leaf.id, a), second = record_of(q, leaf.id + 3, b);
    const float reach = max(a.counted_extent(), b.counted_extent());
    scale_plane(first, plane_scale(reach));
    scale_plane(second, plane_scale(reach));
    FilterResult result{};
    result.verdict = filter_pair(first, second, {}, points, reach);
    result.ball = ball_of(to_float(points[leaf.id[0]]), to_float(points[leaf.id[1]]), to_float(points[leaf.id[2]]));
    result.joins = joins(dot(a.low, a.low), 1.0f, result.ball.r, bisector_radius_factor(b.high));
    return result;
}

__global__ void filter_all(const Leaf* leaves, int count, FilterResult* results) {
    const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
    if (i < count) results[i] = filter_result(leaves[i]);
}

TEST_F(Device, filters_match_the_host) {
    RandomPairs random(Kind::random_float, 73);
    std::vector<Leaf> leaves(20'000);
    for (Leaf& leaf : leaves) {
        for (int row = 0; row < 6; ++row) {
            const Vec3f p = to_float(random.point());
            leaf.rows[4 * row] = p.x, leaf.rows[4 * row + 1] = p.y, leaf.rows[4 * row + 2] = p.z;
            leaf.rows[4 * row + 3] = 0;
            leaf.id[row] = row;
        }
        leaf.id[3] = random.integer(4);  // sometimes an adjacent triangle
        leaf.frame = {{0.25f, 0, 0}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, random.integer(4) ? 2.0f : 0.9f};
    }
    const portable::Array<Leaf> input(leaves);
    const portable::Array<FilterResult> output(leaves.size());
    portable::launch(filter_all, static_cast<unsigned>((leaves.size() + 127) / 128), 128, 0, input.data(),
                     static_cast<int>(leaves.size()), output.data());
    const std::vector<FilterResult> found = output.values();
    for (std::size_t i = 0; i < leaves.size(); ++i) {
        const FilterResult expected = filter_result(leaves[i]);
        ASSERT_EQ(found[i].verdict, expected.verdict) << i;
        ASSERT_EQ(found[i].ball.r, expected.ball.r) << i;
        ASSERT_EQ(found[i].joins, expected.joins) << i;
    }
}

// Tree of two levels: three centres, and two below each of them.
struct Tree {
    std::int32_t first[2][4] = {{0, 3}, {0, 2, 4, 6}};
    PartSiblings centres[2][3];
    double apart[2][6 * max_clusters];

    explicit Tree(RandomPairs& random) {
        for (int l = 0; l < 2; ++l)
            for (int node = 0; node < (l ? 3 : 1); ++node) place(random, l, node);
    }
    void place(RandomPairs& random, int l, int node) {
        PartSiblings& c = centres[l][node];
        const int begin = first[l][node], count = first[l][node + 1] - begin;
        for (int k = 0; k < count; ++k) {
            const Vec3d p = random.point();
            c.x[k] = p.x, c.y[k] = p.y, c.z[k] = p.z;
        }
        for (int k = 0; k < count; ++k)
            for (int j = 0; j < count; ++j) {
                const Vec3d between = c.centre(k) - c.centre(j);
                apart[l][(begin + k) * max_clusters + j] = std::sqrt(dot(between, between));
            }
    }
    CRUMPLE_HD PartTree view() const {
        PartTree tree;
        tree.depth = 2;
        for (int l = 0; l < 2; ++l) tree.level[l] = {first[l], centres[l], apart[l]};
        return tree;
    }
    // Returns all parts and masks of a triangle combined in one number.
    CRUMPLE_HD std::uint64_t digest(const Triangle& triangle) const {
        std::uint64_t digest = 0;
        const PartTree tree = view();
        tree.for_each_part(PartBall(triangle, tree.normalise), [&](std::int32_t part, const std::uint64_t* masks) {
            digest = digest * 1000 + static_cast<std::uint64_t>(part + 1) * 100 + masks[0] * 10 + masks[1];
        });
        return digest;
    }
};

__global__ void digest_all(const Tree* tree, const TrianglePair* pairs, int count, std::uint64_t* digests) {
    const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
    if (i < count) digests[i] = tree->digest(pairs[i].a);
}

TEST_F(Device, assignment_of_triangles_to_parts_matches_the_host) {
    RandomPairs random(Kind::random_float, 11);
    const std::vector<Tree> tree{Tree(random)};
    std::vector<TrianglePair> pairs;
    for (int i = 0; i < rounds; ++i) pairs.push_back(random());
    const portable::Array<Tree> device_tree(tree);
    const portable::Array<TrianglePair> input(pairs);
    const portable::Array<std::uint64_t> output(pairs.size());
    portable::launch(digest_all, static_cast<unsigned>((pairs.size() + 127) / 128), 128, 0, device_tree.data(),
                     input.data(), static_cast<int>(pairs.size()), output.data());
    const std::vector<std::uint64_t> found = output.values();
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        ASSERT_NE(found[i], 0u) << i;
        ASSERT_EQ(found[i], tree[0].digest(pairs[i].a)) << i;
    }
}

}  // namespace
}  // namespace crumple
