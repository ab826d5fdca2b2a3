// Tests of worlds whose poses are on the device. Calls only the CUDA runtime, so that it runs on a device or on one
// that the CPU emulates.

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "crumple/error.h"
#include "cuda/device_world.h"
#include "cuda/downloaded_results.h"
#include "cuda/recorder.h"
#include "error_of.h"
#include "features/joined_blocks.h"
#include "soups.h"
#include "worlds/compare_worlds.h"

namespace crumple::test {
namespace {

constexpr std::array all_outputs{Output::any,   Output::any_by_world, Output::body_pairs,
                                 Output::count, Output::pairs,        Output::contacts};

/// Returns a random world with poses, whose named shapes have names that no other world uses.
std::unique_ptr<RandomWorld> posed_world(unsigned seed, const WorldKind& kind) {
    auto world = random_world(seed, kind);
    world->poses.resize(world->bodies.size());
    for (Shape& shape : world->shapes)
        if (shape.name != 0) shape.name += 1000 * (seed + 1);
    return world;
}

std::vector<Pose> moved(const std::vector<Pose>& poses, unsigned seed, double extent = 0.6) {
    Dice dice(seed);
    std::vector<Pose> out = poses;
    for (Pose& pose : out) pose = random_pose(dice, extent);
    return out;
}

const std::vector<WorldKind> kinds{
    {},
    {.named = 1, .mixed_precision = false},
    {.bodies = 0},
    {.bodies = 1},
    {.bodies = 14, .worlds = 5, .gaps = 0.3},
    {.bodies = 30, .worlds = 12, .named = 0, .everywhere = 0.1},
    {.shapes = 6, .bodies = 12, .worlds = 3, .everywhere = 0.7},
};

TEST(CudaDeviceWorlds, results_match_brute_force) {
    Detector cuda({.backend = Backend::cuda}), small({.backend = Backend::cuda, .leaf_size = 12});
    Detector reference({.backend = Backend::reference});
    for (unsigned seed = 0; seed < 2; ++seed)
        for (std::size_t k = 0; k < kinds.size(); ++k) {
            const unsigned number = 100 * seed + static_cast<unsigned>(k);
            const auto world = posed_world(number, kinds[k]);
            const DeviceWorld device(world->view());
            for (const Output output : all_outputs) {
                SCOPED_TRACE(testing::Message() << "world " << number << ", wants " << static_cast<int>(output));
                IntersectionQuery query = random_query(7 * number + static_cast<unsigned>(output), kinds[k].bodies);
                query.output = output;
                Detector& detector = number % 2 ? small : cuda;
                ASSERT_TRUE(
                    same_world_result(detector.find(device.view(), query), reference.find(world->view(), query)));
            }
        }
}

TEST(CudaDeviceWorlds, results_match_the_cpu_for_float32_poses) {
    const auto world = posed_world(3, {.bodies = 14, .worlds = 4, .mixed_precision = false});
    for (Pose& pose : world->poses)
        for (double& x : pose.rows) x = static_cast<double>(static_cast<float>(x));
    const DeviceWorld device(world->view(), true);
    Detector cuda({.backend = Backend::cuda}), cpu({.backend = Backend::cpu});
    const Intersections& expected = cpu.find(world->view());
    ASSERT_GT(expected.count, 0);
    EXPECT_TRUE(same_world_result(cuda.find(device.view()), expected));
    EXPECT_TRUE(shows_world(cuda.launch(device.view()).wait(), expected));
}

TEST(CudaDeviceWorlds, launch_results_on_the_device_match_the_cpu) {
    Detector cuda({.backend = Backend::cuda}), cpu({.backend = Backend::cpu});
    cudaStream_t stream;
    check(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking));
    for (std::size_t k = 0; k < kinds.size(); ++k) {
        const auto world = posed_world(500 + static_cast<unsigned>(k), kinds[k]);
        DeviceWorld device(world->view());
        for (const Output output : all_outputs) {
            if (output == Output::body_pairs) continue;
            IntersectionQuery query = random_query(11 * static_cast<unsigned>(k), kinds[k].bodies);
            query.index = false;
            for (int frame = 0; frame < 4; ++frame) {
                SCOPED_TRACE(testing::Message()
                             << "kind " << k << ", wants " << static_cast<int>(output) << ", frame " << frame);
                const auto poses = moved(world->poses, static_cast<unsigned>(frame / 2));
                device.set_poses(poses);
                query.output = output;
                const auto launched = cuda.launch(device.view(stream), query);
                const DeviceIntersections& found = launched.wait();
                EXPECT_EQ(found.pairs != nullptr, output >= Output::pairs);
                EXPECT_EQ(found.contact_kinds != nullptr, output == Output::contacts);
                query.output = std::max(output, Output::pairs);
                ASSERT_TRUE(shows_world(found, cpu.find(World{world->shapes, world->bodies, poses}, query)));
            }
        }
    }
    check(cudaStreamDestroy(stream));
}

// The second launch may have other bodies than the first one, even if the lists of the first one were too short, so
// that wait() runs it again after the second has been launched.
TEST(CudaDeviceWorlds, two_launches_in_flight_match_the_cpu) {
    const auto one = posed_world(21, {.bodies = 20, .worlds = 6, .named = 1, .mixed_precision = false});
    const auto two = posed_world(22, {.bodies = 12, .worlds = 3, .named = 0});
    const auto many = random_soup<float>(260, 0.8, 3);
    one->shapes[0] = Shape(many.view(), 77);
    const DeviceWorld first(one->view()), second(two->view());
    Detector cuda({.backend = Backend::cuda}), cpu({.backend = Backend::cpu});
    const Intersections of_one = cpu.find(one->view()), of_two = cpu.find(two->view());
    ASSERT_GT(of_one.count, 3000);
    const auto mesh = random_soup<float>(90, 0.4, 9);
    const DeviceMesh device(mesh.view());
    for (int turn = 0; turn < 4; ++turn) {
        SCOPED_TRACE(turn);
        const auto one_launched = cuda.launch(first.view()), two_launched = cuda.launch(second.view());
        EXPECT_STREQ(error_of([&] { cuda.launch(first.view()); }).what(),
                     "two launches are in flight; call wait() before the next launch");
        EXPECT_TRUE(shows_world(one_launched.wait(), of_one));
        const auto again = cuda.launch(first.view());
        EXPECT_TRUE(shows_world(two_launched.wait(), of_two));
        std::optional<LaunchTicket<IntersectionQuery>> mesh_launched;
        if (turn == 2) mesh_launched = cuda.launch(device.view());
        EXPECT_TRUE(shows_world(again.wait(), of_one));
        if (!mesh_launched) continue;
        const Intersections& of_mesh = cpu.find(mesh.view());
        EXPECT_TRUE(shows(mesh_launched->wait(), mesh.view(), nullptr, of_mesh));
    }
}

TEST(CudaDeviceWorlds, launches_of_worlds_and_meshes_may_alternate) {
    const auto world = posed_world(31, {.bodies = 8, .worlds = 3});
    const DeviceWorld device(world->view());
    const auto mesh = random_soup<float>(90, 0.4, 9);
    const DeviceMesh on_device(mesh.view());
    Detector cuda({.backend = Backend::cuda});
    const auto message_of = [](auto call) { return std::string(error_of(call).what()); };
    const auto older = cuda.launch(device.view()), of_mesh = cuda.launch(on_device.view());
    EXPECT_EQ(older.wait().worlds, 3);
    EXPECT_EQ(message_of([&] { older.download(); }),
              "download() is for launches of meshes, and must come right after their wait()");
    const auto newer = cuda.launch(device.view());
    EXPECT_EQ(of_mesh.wait().hit_count, 90);
    EXPECT_EQ(newer.wait().worlds, 3);
}

TEST(CudaDeviceWorlds, results_match_the_cpu_after_worlds_change_between_calls) {
    const auto world = posed_world(41, {.bodies = 16, .worlds = 4, .named = 0.5});
    Detector cuda({.backend = Backend::cuda}), cpu({.backend = Backend::cpu});
    const auto compare = [&](const IntersectionQuery& query = {}) {
        const DeviceWorld device(world->view());
        const Intersections& expected = cpu.find(world->view(), query);
        EXPECT_TRUE(same_world_result(cuda.find(device.view(), query), expected));
        EXPECT_TRUE(shows_world(cuda.launch(device.view(), query).wait(), expected));
        return expected.count;
    };
    const std::int64_t before = compare();
    ASSERT_GT(before, 0);
    IntersectionQuery query;
    query.filter.excluded_bodies = {{0, 1}, {2, 5}};
    query.filter.bodies = PairScope::between;
    compare(query);
    query.filter.excluded_groups = {{0, 0}};
    compare(query);
    world->bodies[3].self = !world->bodies[3].self;
    compare();
    world->bodies[2].group += 7;
    compare(query);
    // The vertices of an unnamed shape move in place.
    auto soup = random_soup<float>(40, 0.5, 5);
    world->shapes.push_back(Shape(soup.view()));
    for (Body& body : world->bodies) body.shape = static_cast<std::int32_t>(world->shapes.size()) - 1;
    const std::int64_t still = compare();
    for (auto& vertex : soup.vertices) vertex[0] *= 3;
    EXPECT_NE(compare(), still);
    world->bodies.pop_back();
    world->poses.pop_back();
    compare();
    world->shapes.back().name = 4711;
    compare();
    for (std::size_t t = 0; t < soup.triangles.size(); ++t) soup.groups.push_back(static_cast<int>(t) % 2);
    world->shapes.back().groups = soup.groups;
    compare(query);
    soup.groups.assign(soup.groups.size(), 0);
    compare(query);
    const auto other = random_soup<float>(41, 0.5, 6);
    world->shapes.back() = Shape(other.view(), 4711);
    const DeviceWorld device(world->view());
    const Error error = error_of([&] { cuda.find(device.view()); });
    EXPECT_EQ(error.element, Element::shape);
}

TEST(CudaDeviceWorlds, error_of_a_bad_pose_names_the_body) {
    const auto soup = random_soup<float>(30, 0.4, 5);
    const std::vector<Shape> shapes{Shape(soup.view(), 1)};
    std::vector<Body> bodies;
    for (int b = 0; b < 6; ++b) bodies.push_back({.world = b / 2, .self = true});
    std::vector<Pose> good(6), nan = good, huge = good;
    nan[3].rows[5] = std::numeric_limits<double>::quiet_NaN();
    huge[4].rows[3] = 1e39;
    DeviceWorld device({shapes, bodies, good});
    Detector cuda({.backend = Backend::cuda}), cpu({.backend = Backend::cpu});
    const Intersections expected = cpu.find(World{shapes, bodies, good});
    const auto expect_bad = [&](auto call) {
        device.set_poses(nan);
        Error error = error_of(call);
        EXPECT_STREQ(error.what(), "body 3: its pose is not finite");
        EXPECT_EQ(error.element, Element::body);
        EXPECT_EQ(error.index, 3);
        device.set_poses(huge);
        error = error_of(call);
        EXPECT_STREQ(error.what(), "body 4: vertex 0 is posed to infinity");
        EXPECT_EQ(error.code, ErrorCode::not_finite);
        device.set_poses(good);
    };
    for (const Output output : {Output::any_by_world, Output::pairs}) {
        expect_bad([&] { cuda.find(device.view(), {.output = output}); });
        EXPECT_EQ(cuda.find(device.view(), {.output = output}).any, expected.any);
    }
    expect_bad([&] { cuda.launch(device.view()).wait(); });
    Recorder recorder;
    for (int call = 0; call < 2; ++call) cuda.launch(device.view(recorder.stream())).wait();
    recorder.begin();
    const auto launched = cuda.launch(device.view(recorder.stream()));
    recorder.end();
    for (int turn = 0; turn < 2; ++turn) {
        expect_bad([&] { recorder.replay(), launched.wait(); });
        recorder.replay();
        EXPECT_TRUE(shows_world(launched.wait(), expected));
    }
}

TEST(CudaDeviceWorlds, each_complete_replay_of_a_captured_launch_matches_the_cpu) {
    const auto world = posed_world(51, {.bodies = 40, .worlds = 12, .named = 1});
    DeviceWorld device(world->view());
    Detector cuda({.backend = Backend::cuda}), cpu({.backend = Backend::cpu});
    for (const IntersectionQuery& query : {IntersectionQuery{.output = Output::any_by_world},
                                           {.output = Output::contacts},
                                           IntersectionQuery{.output = Output::pairs, .weld = true}}) {
        SCOPED_TRACE(testing::Message() << "wants " << static_cast<int>(query.output));
        Recorder recorder;
        const World view = device.view(recorder.stream());
        recorder.begin();
        EXPECT_EQ(std::string(error_of([&] { cuda.launch(view, query); }).what()).substr(0, 97),
                  "a launch in a capture needs two calls before it, outside of the capture, with the same bodies and");
        recorder.end();
        for (int call = 0; call < 3; ++call) cuda.launch(view, query).wait();
        recorder.begin();
        const auto launched = cuda.launch(view, query);
        recorder.end();
        int complete = 0;
        for (unsigned frame = 0; frame < 6; ++frame) {
            const auto poses = moved(world->poses, frame / 2, 1.5);
            device.set_poses(poses);
            recorder.replay();
            const DeviceIntersections& found = launched.wait();
            if (!found.complete) {
                EXPECT_EQ(found.world_hit, nullptr);
                continue;
            }
            ++complete;
            IntersectionQuery all = query;
            all.output = std::max(query.output, Output::pairs);
            EXPECT_TRUE(shows_world(found, cpu.find(World{world->shapes, world->bodies, poses}, all))) << frame;
        }
        EXPECT_GE(complete, 3);
        device.set_poses(world->poses);
        cuda.find(device.view());
    }
}

TEST(CudaDeviceWorlds, impacts_proximities_and_candidates_match_the_cpu) {
    const auto world = posed_world(71, {.bodies = 14, .worlds = 4, .mixed_precision = false});
    const std::vector<Pose> ends = moved(world->poses, 5);
    World host = world->view();
    host.end_poses = ends;
    const DeviceWorld start(world->view());
    World at_end = world->view();
    at_end.poses = ends;
    const DeviceWorld end(at_end);
    World on_device = start.view();
    on_device.device_end_poses = end.view().device_poses;
    Detector cuda({.backend = Backend::cuda}), cpu({.backend = Backend::cpu});
    EXPECT_GT(cpu.find(host, ImpactQuery()).count, 0);
    EXPECT_TRUE(same_whole(cuda.find(on_device, ImpactQuery()), cpu.find(host, ImpactQuery())));
    EXPECT_TRUE(same_whole(cuda.find(start.view(), ImpactQuery()), cpu.find(world->view(), ImpactQuery())));
    EXPECT_TRUE(
        same_whole(cuda.find(on_device, ProximityQuery{.radius = 0.1}), cpu.find(host, ProximityQuery{.radius = 0.1})));
    EXPECT_TRUE(same_whole(cuda.find(on_device, CandidateQuery()), cpu.find(host, CandidateQuery())));
}

TEST(CudaDeviceWorlds, unsupported_calls_are_rejected) {
    const auto world = posed_world(61, {.bodies = 6, .worlds = 2});
    const DeviceWorld device(world->view());
    Detector cuda({.backend = Backend::cuda}), cpu({.backend = Backend::cpu});
    const auto message_of = [](auto call) {
        const Error error = error_of(call);
        EXPECT_EQ(error.code, ErrorCode::invalid_argument);
        return std::string(error.what());
    };
    EXPECT_EQ(message_of([&] { cuda.launch(device.view(), {.output = Output::body_pairs}); }),
              "output must not be body_pairs: launches do not support it; use find()");
    EXPECT_EQ(message_of([&] { cuda.launch(device.view(), {.index = true}); }),
              "index must be false: launches make offsets by world only");
    EXPECT_EQ(message_of([&] { cuda.launch(device.view(), {.output = Output::any, .containment = true}); }),
              "containment must be false: launches do not support it");
    EXPECT_EQ(message_of([&] { cuda.launch(world->view()); }), "launches of worlds need poses in device memory");
    EXPECT_EQ(message_of([&] { cpu.launch(device.view()); }),
              "poses in device memory need the cuda backend (Options::backend)");
    for (const auto& call : std::vector<std::function<void()>>{
             [&] { cpu.find(device.view()); }, [&] { cpu.find(device.view(), ProximityQuery{.radius = 1}); },
             [&] { cpu.find(device.view(), DistanceQuery()); },
             [&] { cpu.stream(device.view(), IntersectionQuery(), [](const Intersections&) {}); }})
        EXPECT_EQ(message_of(call), "poses in device memory need the cuda backend (Options::backend)");
    World wrong = device.view();
    wrong.end_poses = world->poses;
    EXPECT_EQ(message_of([&] { cuda.find(wrong, ImpactQuery()); }),
              "poses must be in device memory or in host memory, not in both");
    wrong = world->view();
    wrong.device_end_poses = device.view().device_poses;
    wrong.poses = {};
    EXPECT_EQ(message_of([&] { cuda.find(wrong, ImpactQuery()); }),
              "poses at the start must be in device memory, like those at the end");
    wrong = device.view();
    wrong.device_end_poses = {static_cast<const double*>(wrong.device_poses.data), 7};
    EXPECT_EQ(message_of([&] { cuda.find(wrong, ImpactQuery()); }), "there are 7 poses for 6 bodies");
    wrong = device.view();
    wrong.device_poses.count = 5;
    EXPECT_EQ(message_of([&] { cuda.find(wrong); }), "there are 5 poses for 6 bodies");
    wrong = device.view();
    wrong.poses = world->poses;
    EXPECT_EQ(message_of([&] { cuda.launch(wrong); }), "poses must be in device memory or in host memory, not in both");
    wrong = device.view();
    wrong.device_poses.data = static_cast<const std::byte*>(wrong.device_poses.data) + 4;
    EXPECT_EQ(message_of([&] { cuda.find(wrong); }), "poses must be aligned to their number type");
    int pages = 0;
    check(cudaDeviceGetAttribute(&pages, cudaDevAttrPageableMemoryAccess, 0));
    if (!pages) {
        wrong = device.view();
        wrong.device_poses.data = world->poses.data();
        for (const bool launched : {false, true})
            EXPECT_EQ(message_of([&] { launched ? void(cuda.launch(wrong)) : void(cuda.find(wrong)); }),
                      "poses lie in host memory, which CUDA device 0 cannot read");
    }
    EXPECT_TRUE(same_world_result(cuda.find(device.view()), cpu.find(world->view())));
}

}  // namespace
}  // namespace crumple::test
