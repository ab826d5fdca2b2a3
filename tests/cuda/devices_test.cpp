// Tests of several devices that divide a query (Options::devices), with two to four emulated devices: results equal
// those of one backend byte by byte.

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
#include "distributed/rank_detector.h"
#include "distributed/rank_failures.h"
#include "distributed/thread_ranks.h"
#include "error_of.h"
#include "features/compare_features.h"
#include "worlds/compare_worlds.h"

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

TEST_F(Devices, moving_and_changing_meshes_match_the_cpu) {
    for (const std::vector<int>& devices : {std::vector{0, 1}, std::vector{3, 1, 0, 2}, std::vector{2}}) {
        Detector several(some(devices)), one({.backend = Backend::cpu});
        for (const bool contacts : {false, true})
            for (int frame = 0; frame < 3; ++frame) {
                const WholeMesh sheet(wavy_sheet<float>(14, 0.3 + 0.01 * frame));
                const IntersectionQuery query{.output = contacts ? Output::contacts : Output::pairs};
                ASSERT_TRUE(same_result(several.find(sheet.view(), query), one.find(sheet.view(), query)));
                EXPECT_TRUE(several.any(sheet.view()));
            }
        const WholeMesh soup(random_soup<double>(120, 0.2));
        ASSERT_TRUE(same_result(several.find(soup.view()), one.find(soup.view())));
        const WholeMesh nothing(Soup<float>{});
        EXPECT_FALSE(several.any(nothing.view()));
        EXPECT_EQ(several.find(soup.view()).statistics.backend, "cuda");
    }
}

TEST_F(Devices, hard_soups_match_the_cpu) {
    Detector several(some({0, 1, 2})), one({.backend = Backend::cpu});
    std::size_t number = 0;
    for (const NamedMesh& soup : hard_soups()) {
        const std::array scopes{PairScope::both, PairScope::between, PairScope::within};
        IntersectionQuery query{.output = number % 3 == 0 ? Output::contacts : Output::pairs,
                                .weld = number % 2 == 0,
                                .filter = {.groups = scopes[number % 3]}};
        const std::vector<GroupPair> excluded{{0, 1}};
        if (number % 4 == 3) query.filter.excluded_groups = excluded;
        const WholeMesh mesh(soup.mesh);
        ASSERT_TRUE(same_result(several.find(mesh.view(), query), one.find(mesh.view(), query))) << soup.name;
        ++number;
    }
}

TEST_F(Devices, impacts_and_proximities_match_the_cpu) {
    Detector several(some({0, 1, 2})), one({.backend = Backend::cpu});
    for (const Step& step : {Step(WholeMesh(wavy_sheet<float>(8))), Step(WholeMesh(random_soup<double>(60, 0.3)))}) {
        for (const Output output : {Output::pairs, Output::first, Output::any}) {
            const ImpactQuery motion{.output = output, .min_distance = 0.01, .index = output == Output::pairs};
            ASSERT_TRUE(same_features(several.find(step.start.view().moving_to(step.end_view()), motion),
                                      one.find(step.start.view().moving_to(step.end_view()), motion)));
        }
        for (const Output output : {Output::pairs, Output::any}) {
            const ProximityQuery near{.output = output, .radius = 0.05, .closest = true};
            ASSERT_TRUE(same_features(several.find(step.start.view(), near), one.find(step.start.view(), near)));
        }
    }
}

TEST_F(Devices, two_meshes_rings_a_world_and_an_ample_memory_limit_match_the_cpu) {
    Detector several(some({1, 0})), one({.backend = Backend::cpu});
    const WholeMesh sheet(wavy_sheet<float>(10)), soup(random_soup<float>(80, 0.3));
    EXPECT_TRUE(same_result(several.find({sheet.view(), soup.view()}), one.find({sheet.view(), soup.view()})));
    const ProximityQuery rings{.radius = 0.05, .rings = 2};
    EXPECT_TRUE(same_features(several.find(sheet.view(), rings), one.find(sheet.view(), rings)));
    const std::vector<Shape> shapes{Shape(sheet.view()), Shape(soup.view())};
    const std::vector<Body> bodies{{0}, {1}};
    const World world{shapes, bodies, {}};
    EXPECT_TRUE(same_world_result(several.find(world), one.find(world)));
    Options limited = some({0, 1});
    limited.memory_limit = 64 << 20;
    Detector with_less(limited);
    EXPECT_TRUE(same_result(with_less.find(sheet.view()), one.find(sheet.view())));
}

TEST_F(Devices, detector_stays_usable_after_bad_input_stop_and_throwing_poll) {
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
    const Error error = error_of([&] { several.find(broken.view()); });
    EXPECT_EQ(error.code, ErrorCode::not_finite);
    EXPECT_EQ(error.index, 1);
    EXPECT_EQ(error.rank, -1);

    std::stop_source stop;
    stop.request_stop();
    EXPECT_EQ(error_of([&] { several.find(sheet.view(), {}, stop.get_token()); }).code, ErrorCode::cancelled);
    int polls = 0;
    several.set_poll([&] {
        if (++polls == 1) throw std::domain_error("enough");
    });
    // Repeats the call until it lasts long enough to poll. The exception that the poll throws must arrive unchanged.
    try {
        while (polls == 0) several.find(WholeMesh(wavy_sheet<float>(40)).view());
        FAIL() << "nothing was thrown";
    } catch (const std::domain_error&) {
    }
    several.set_poll({});
    EXPECT_TRUE(same_result(several.find(sheet.view()), one.find(sheet.view())));
}

// Local meshes may be on the ranks' devices; they are copied to the host.
TEST_F(Devices, ranks_match_a_single_detector_for_local_meshes_on_devices) {
    constexpr int ranks = 2;
    const Step step(WholeMesh(wavy_sheet<float>(10)));
    Detector one({.backend = Backend::cpu});
    const Intersections pairs = one.find(step.start.view());
    const Impacts impacts = one.find(step.start.view().moving_to(step.end_view()), ImpactQuery());
    RankFailures verdicts;
    run_ranks(ranks, [&](distribute::Transport& transport) {
        const int rank = transport.rank();
        const MeshPiece start(step.start, Distribution::random, rank, ranks),
            end(step.end, Distribution::random, rank, ranks);
        const DeviceMesh on_device(start.local().mesh), end_on_device(end.local().mesh);
        DistributedOptions options;
        options.detector.backend = Backend::cuda;
        distribute::RankDetector detector(transport, options);
        LocalMesh share = start.local();
        share.mesh = on_device.view();
        for (int frame = 0; frame < 2; ++frame)
            verdicts.add(rank, rows_are(detector.find(share), start.triangle_ids, pairs));
        verdicts.add(rank, rows_are(detector.find(share.moving_to(end_on_device.view().vertices), ImpactQuery()),
                                    start.triangle_ids, impacts, step.start));
    });
    EXPECT_TRUE(verdicts.all());
}

}  // namespace
}  // namespace crumple::test
