// Several devices that share a question (Options::devices), two or four of which the CPU plays: byte for byte the
// answer of one backend.

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <vector>

#include "agreement/compare.h"
#include "agreement/hard_soups.h"
#include "crumple/crumple.h"
#include "cuda_on_cpu/machine/settings.h"
#include "device_mesh.h"
#include "distributed/feature_rows.h"
#include "distributed/pretended_ranks.h"
#include "distributed/rank_detector.h"
#include "distributed/verdicts.h"
#include "error_of.h"
#include "features/compare_features.h"

namespace crumple::test {
namespace {

class Devices : public testing::Test {
   protected:
    void SetUp() override { cuda_on_cpu::settings().devices = 4; }
    void TearDown() override { cuda_on_cpu::settings().devices = 1; }

    static Options some(std::vector<int> devices) {
        Options options;
        options.backend = Backend::cuda;
        options.devices = std::move(devices);
        return options;
    }
};

TEST_F(Devices, share_meshes_that_move_and_change) {
    for (const std::vector<int>& devices : {std::vector{0, 1}, std::vector{3, 1, 0, 2}, std::vector{2}}) {
        Detector several(some(devices)), one({.backend = Backend::cpu});
        for (const bool contacts : {false, true})
            for (int frame = 0; frame < 3; ++frame) {
                const WholeMesh sheet(wavy_sheet<float>(14, 0.3 + 0.01 * frame));
                const Query query{.contacts = contacts};
                ASSERT_TRUE(same_answer(several.find_self(sheet.view(), query), one.find_self(sheet.view(), query)));
                EXPECT_TRUE(several.has_collision(sheet.view()));
            }
        const WholeMesh soup(random_soup<double>(120, 0.2));
        ASSERT_TRUE(same_answer(several.find_self(soup.view()), one.find_self(soup.view())));
        const WholeMesh nothing(Soup<float>{});
        EXPECT_FALSE(several.has_collision(nothing.view()));
        EXPECT_EQ(several.find_self(soup.view()).statistics.backend, "cuda");
    }
}

TEST_F(Devices, share_hard_soups) {
    Detector several(some({0, 1, 2})), one({.backend = Backend::cpu});
    std::size_t number = 0;
    for (const NamedMesh& soup : hard_soups()) {
        const std::array wanted{Wanted::both, Wanted::between, Wanted::within};
        Query query{.weld = number % 2 == 0, .contacts = number % 3 == 0, .wanted = wanted[number % 3]};
        const std::array<GroupPair, 1> excluded{{{0, 1}}};
        if (number % 4 == 3) query.excluded_groups = excluded;
        const WholeMesh mesh(soup.mesh);
        ASSERT_TRUE(same_answer(several.find_self(mesh.view(), query), one.find_self(mesh.view(), query))) << soup.name;
        ++number;
    }
}

TEST_F(Devices, share_motion_and_nearness) {
    Detector several(some({0, 1, 2})), one({.backend = Backend::cpu});
    for (const Step& step : {Step(WholeMesh(wavy_sheet<float>(8))), Step(WholeMesh(random_soup<double>(60, 0.3)))}) {
        for (const MotionWants wants : {MotionWants::impacts, MotionWants::earliest, MotionWants::any}) {
            const Motion motion{.wants = wants, .separation = 0.01, .index = wants == MotionWants::impacts};
            ASSERT_TRUE(same_features(several.find_impacts(step.start.view(), step.end_view(), motion),
                                      one.find_impacts(step.start.view(), step.end_view(), motion)));
        }
        for (const NearWants wants : {NearWants::pairs, NearWants::any}) {
            const Near near{.wants = wants, .radius = 0.05, .closest = true};
            ASSERT_TRUE(
                same_features(several.find_near(step.start.view(), near), one.find_near(step.start.view(), near)));
        }
    }
}

TEST_F(Devices, leave_the_rest_to_the_first) {
    Detector several(some({1, 0})), one({.backend = Backend::cpu});
    const WholeMesh sheet(wavy_sheet<float>(10)), soup(random_soup<float>(80, 0.3));
    EXPECT_TRUE(
        same_answer(several.find_between(sheet.view(), soup.view()), one.find_between(sheet.view(), soup.view())));
    const Near rings{.radius = 0.05, .rings = 2};
    EXPECT_TRUE(same_features(several.find_near(sheet.view(), rings), one.find_near(sheet.view(), rings)));
    const std::vector<Shape> shapes{Shape(sheet.view()), Shape(soup.view())};
    const std::vector<Body> bodies{{0}, {1}};
    const World world{shapes, bodies, {}};
    EXPECT_EQ(several.find(world, Intersect()).count, one.find(world, Intersect()).count);
    Options limited = some({0, 1});
    limited.memory_limit = 64 << 20;
    Detector with_less(limited);
    EXPECT_TRUE(same_answer(with_less.find_self(sheet.view()), one.find_self(sheet.view())));
}

TEST_F(Devices, fail_together_and_go_on) {
    const WholeMesh sheet(wavy_sheet<float>(12));
    const auto code_of = [](std::vector<int> devices) {
        return error_of([&] { Detector detector(some(std::move(devices))); }).code;
    };
    EXPECT_EQ(code_of({0, 4}), ErrorCode::backend_unavailable);
    EXPECT_EQ(code_of({1, 1}), ErrorCode::invalid_argument);
    EXPECT_EQ(code_of({-1}), ErrorCode::invalid_argument);

    Detector several(some({0, 1, 2})), one({.backend = Backend::cpu});
    WholeMesh broken = sheet;
    std::get<std::vector<float>>(broken.vertices)[5] = std::numeric_limits<float>::quiet_NaN();
    const Error error = error_of([&] { several.find_self(broken.view()); });
    EXPECT_EQ(error.code, ErrorCode::not_finite);
    EXPECT_EQ(error.index, 1);
    EXPECT_EQ(error.rank, -1);

    std::stop_source stop;
    stop.request_stop();
    EXPECT_EQ(error_of([&] { several.find_self(sheet.view(), {}, stop.get_token()); }).code, ErrorCode::cancelled);
    int polls = 0;
    several.set_poll([&] {
        if (++polls == 1) throw std::domain_error("enough");
    });
    // Polls come every 20 ms at most: once there has been one, its exception arrives here as it is.
    try {
        while (polls == 0) several.find_self(WholeMesh(wavy_sheet<float>(40)).view());
        FAIL() << "nothing was thrown";
    } catch (const std::domain_error&) {
    }
    several.set_poll({});
    EXPECT_TRUE(same_answer(several.find_self(sheet.view()), one.find_self(sheet.view())));
}

// What ranks bring may lie on their devices; it goes through the host.
TEST_F(Devices, may_hold_what_ranks_bring) {
    constexpr int ranks = 2;
    const Step step(WholeMesh(wavy_sheet<float>(10)));
    Detector one({.backend = Backend::cpu});
    const Collisions pairs = one.find_self(step.start.view());
    const Impacts impacts = one.find_impacts(step.start.view(), step.end_view());
    Verdicts verdicts;
    run_ranks(ranks, [&](distribute::Transport& transport) {
        const int rank = transport.rank();
        const MeshPiece start(step.start, Distribution::random, rank, ranks),
            end(step.end, Distribution::random, rank, ranks);
        const DeviceMesh there(start.share().mesh), there_at_end(end.share().mesh);
        DistributedOptions options;
        options.detector.backend = Backend::cuda;
        distribute::RankDetector detector(transport, options);
        MeshShare share = start.share();
        share.mesh = there.view();
        for (int frame = 0; frame < 2; ++frame)
            verdicts.add(rank, rows_are(detector.find_self(share, {}), start.triangle_ids, pairs));
        verdicts.add(rank, rows_are(detector.find_impacts(share, there_at_end.view().vertices, {}), start.triangle_ids,
                                    impacts, step.start));
    });
    EXPECT_TRUE(verdicts.all());
}

}  // namespace
}  // namespace crumple::test
