// Tests of the membership rule: a ball belongs to every cluster whose centre may be the nearest one to some point of
// the ball.

#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "backends/cpu/stages/kernels.h"

namespace crumple::cpu {
namespace {

// Returns balls with radii from 2^-21 to 1, a third of them at centres and a third midway between two centres.
Array<Ball> make_balls(const Centres& centres, int count, std::mt19937& engine) {
    const auto number = [&] { return static_cast<float>(static_cast<double>(engine()) * 0x1p-31 - 1); };
    Array<Ball> balls;
    balls.resize(static_cast<std::size_t>(count + padding));
    for (int i = 0; i < count; ++i) {
        const auto any = [&] { return static_cast<int>(engine() % static_cast<unsigned>(centres.count)); };
        const Vec3f a = centres[any()], b = centres[any()];
        const Vec3f c = i % 3 == 0 ? a : i % 3 == 1 ? 0.5f * (a + b) : Vec3f{number(), number(), number()};
        balls[static_cast<std::size_t>(i)] = {c.x, c.y, c.z, std::ldexp(1.0f, -static_cast<int>(engine() % 22))};
    }
    return balls;
}

TEST(ClusterMembership, ball_is_member_of_each_cluster_nearest_to_one_of_its_points) {
    std::mt19937 engine(11);
    const auto number = [&] { return static_cast<double>(engine()) * 0x1p-31 - 1; };
    for (const StageKernels* kernels : all_stage_kernels()) {
        for (const int count : {1, 2, 3, 16, 17, 33, 64}) {
            Centres centres;
            centres.count = count;
            for (int k = 0; k < count; ++k)
                centres.set(k,
                            {static_cast<float>(number()), static_cast<float>(number()), static_cast<float>(number())});
            for (const int n : {1, 3, 16, 100}) {
                const Array<Ball> balls = make_balls(centres, n, engine);
                std::vector<std::uint64_t> mask(static_cast<std::size_t>(n));
                std::array<std::int64_t, max_clusters> counts{}, members{};
                kernels->assign(balls.data(), n, centres, mask.data(), counts.data());
                for (const std::uint64_t m : mask)
                    for (int k = 0; k < max_clusters; ++k) members[static_cast<std::size_t>(k)] += m >> k & 1;
                EXPECT_EQ(counts, members) << kernels->name;
                for (std::size_t i = 0; i < mask.size(); ++i) {
                    ASSERT_NE(mask[i], 0u);
                    if (count < 64) {
                        ASSERT_EQ(mask[i] >> count, 0u) << "no cluster that does not exist";
                    }
                    for (int trial = 0; trial < 30; ++trial) {
                        Vec3d d{number(), number(), number()};
                        const double length = std::sqrt(dot(d, d));
                        if (length == 0) continue;
                        const double reach = trial % 2 ? 1.0 : std::abs(number());  // on the sphere or inside
                        d = (static_cast<double>(balls[i].r) * reach * (1 - 1e-12) / length) * d;
                        const Vec3d p = Vec3d{balls[i].x, balls[i].y, balls[i].z} + d;
                        int nearest = 0;
                        double best = 1e300;
                        for (int k = 0; k < count; ++k) {
                            const Vec3f v = centres[k];
                            const Vec3d w = p - Vec3d{v.x, v.y, v.z};
                            if (dot(w, w) < best) best = dot(w, w), nearest = k;
                        }
                        ASSERT_TRUE(mask[i] >> nearest & 1)
                            << kernels->name << ": ball " << i << ", centre " << nearest << " of " << count;
                    }
                }
            }
        }
    }
}

TEST(ClusterMembership, members_are_listed_and_no_mask_is_written_past_the_end) {
    std::mt19937 engine(7);
    const auto random_mask = [&] { return std::uint64_t{engine()} << 32 | engine(); };
    for (const StageKernels* kernels : all_stage_kernels()) {
        for (const std::size_t n :
             {std::size_t{0}, std::size_t{1}, std::size_t{15}, std::size_t{16}, std::size_t{333}}) {
            std::vector<std::uint64_t> mask(n + 5);
            for (std::uint64_t& m : mask) m = random_mask();
            for (const int child : {0, 1, 31, 32, 63}) {
                std::vector<std::int32_t> expected;
                for (std::size_t m = 5; m < 5 + n; ++m)
                    if (mask[m] >> child & 1) expected.push_back(static_cast<std::int32_t>(m));
                std::vector<std::int32_t> member(expected.size() + padding);
                const std::int64_t count =
                    kernels->list_members(mask.data(), 5, 5 + static_cast<std::int64_t>(n), child, member.data());
                ASSERT_EQ(count, static_cast<std::int64_t>(expected.size())) << kernels->name;
                member.resize(expected.size());
                EXPECT_EQ(member, expected) << kernels->name;
            }
            Centres centres;
            centres.count = 3;
            for (int k = 0; k < 3; ++k) centres.set(k, {0.1f * static_cast<float>(k), 0, 0});
            const Array<Ball> balls = make_balls(centres, static_cast<int>(n), engine);
            constexpr std::uint64_t untouched = 0x123456789abcdef;
            std::vector<std::uint64_t> written(n + padding, untouched);
            std::array<std::int64_t, max_clusters> counts{};
            kernels->assign(balls.data(), static_cast<std::int64_t>(n), centres, written.data(), counts.data());
            for (std::size_t i = 0; i < written.size(); ++i)
                EXPECT_EQ(written[i] == untouched, i >= n) << kernels->name << ": a neighbouring cluster's mask";
        }
    }
}

TEST(ClusterMembership, small_balls_belong_to_few_clusters_on_average) {
    std::mt19937 engine(5);
    const auto number = [&] { return static_cast<float>(static_cast<double>(engine()) * 0x1p-31 - 1); };
    Centres centres;
    centres.count = 16;
    for (int k = 0; k < 16; ++k) centres.set(k, {number(), number(), number()});
    std::vector<Ball> balls;
    for (int i = 0; i < 4000; ++i) balls.push_back({number(), number(), number(), 0.01f});
    for (const StageKernels* kernels : all_stage_kernels()) {
        std::vector<std::uint64_t> mask(balls.size());
        std::array<std::int64_t, max_clusters> counts{};
        kernels->assign(balls.data(), 4000, centres, mask.data(), counts.data());
        const std::int64_t members = std::accumulate(counts.begin(), counts.end(), std::int64_t{0});
        EXPECT_LT(members, 4600) << kernels->name;
    }
}

}  // namespace
}  // namespace crumple::cpu
