// Tests of launches on the caller's stream, whose results stay on the device. Calls only the CUDA runtime, so that it
// runs on a device or on one that the CPU emulates.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "agreement/compare.h"
#include "agreement/hard_soups.h"
#include "crumple/error.h"
#include "cuda/cloth.h"
#include "cuda/device_mesh.h"
#include "cuda/downloaded_results.h"
#include "error_of.h"
#include "halves.h"
#include "memory_limit.h"
#include "rounds.h"
#include "soups.h"

namespace crumple::test {
namespace {

TEST(CudaLaunch, simulation_frames_match_the_cpu) {
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda, .leaf_size = 200});
    cudaStream_t stream;
    check(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking));
    std::optional<DeviceMesh> device;
    std::int64_t pairs = 0;
    for (const int triangles : {600, 1200}) {
        device.reset();
        for (int frame = 0; frame < 94; frame += 12) {
            const io::TriangleMesh mesh = cloth(triangles, frame);
            if (device)
                device->set_vertices(mesh.view());
            else
                device.emplace(mesh.view());
            MeshView view = device->view();
            view.stream = stream;
            const IntersectionQuery query{.output = frame % 24 == 0 ? Output::contacts : Output::pairs};
            const auto launched = cuda.launch(view, query);
            const DeviceIntersections& found = launched.wait();
            const Intersections& expected = cpu.find(mesh.view(), query);
            pairs += found.count;
            ASSERT_TRUE(shows(found, view, nullptr, expected)) << "frame " << frame;
            ASSERT_TRUE(same_result(launched.download(), expected)) << "frame " << frame;
        }
    }
    EXPECT_GT(pairs, 100);
    check(cudaStreamDestroy(stream));
}

// Cached state of the previous frame affects only the cost of the next frame, whatever that contains.
TEST(CudaLaunch, sudden_scene_changes_do_not_affect_results) {
    constexpr int n = 120;
    using Triangles = std::vector<std::array<float, 3>>;
    const Soup<float> first = random_soup(n, 0.2);
    const auto moved = [&](auto change) {
        Triangles vertices = first.vertices;
        for (std::size_t v = 0; v < vertices.size(); ++v) change(v, vertices[v]);
        return vertices;
    };
    const float inf = std::numeric_limits<float>::infinity();
    const std::vector<Triangles> frames{
        first.vertices,
        random_soup(n, 0.2, 2).vertices,
        moved([](std::size_t v, auto& p) {  // one vertex is far away, so all others are in one cluster
            if (v == 7) p[0] = 1e6f;
        }),
        moved([](std::size_t, auto& p) {
            p = {0.5f, 0.5f, 0.5f};
        }),
        moved([&](std::size_t, auto& p) { p[1] = inf; }),  // invalid; in odd frames wait() comes after the next launch
        first.vertices,
        moved([](std::size_t v, auto& p) {  // half of all vertices are close together
            if (v % 2) p = {p[0] / 50, p[1] / 50, p[2] / 50};
        }),
        moved([](std::size_t, auto& p) {
            p = {p[2], 100 * p[0], p[1]};
        }),
        moved([](std::size_t v, auto& p) {
            if (v == 8) p[2] = std::numeric_limits<float>::quiet_NaN();
        }),
    };
    Detector cpu({.backend = Backend::cpu});
    for (const int leaf_size : {40, 5}) {
        Detector cuda({.backend = Backend::cuda, .leaf_size = leaf_size});
        DeviceMesh device(first.view());
        std::optional<LaunchTicket<IntersectionQuery>> older;
        for (std::size_t frame = 0; frame < 2 * frames.size(); ++frame) {
            SCOPED_TRACE(testing::Message() << "leaves of " << leaf_size << ", frame " << frame);
            Soup<float> host = first;
            host.vertices = frames[frame * 5 % frames.size()];
            const bool bad =
                !std::ranges::all_of(host.vertices, [&](const auto& p) { return p[1] < inf && p[2] < inf; });
            device.set_vertices(host.view());
            for (int repeat = 0; repeat < (frame % 3 == 0 ? 4 : 1); ++repeat) {
                const auto launched = cuda.launch(device.view());
                if (older) {
                    EXPECT_THROW(older->wait(), Error);
                }
                older.reset();
                if (bad && frame % 2) {
                    older = launched;
                    break;  // wait() comes after the launch of the next frame
                }
                if (bad)
                    EXPECT_THROW(launched.wait(), Error);
                else
                    EXPECT_TRUE(shows(launched.wait(), host.view(), nullptr, cpu.find(host.view())));
            }
            if (!bad) {
                EXPECT_EQ(cuda.any(device.view()), !cpu.find(host.view()).pairs.empty());
            }
            check(cudaDeviceSynchronize());  // before the next frame's vertices overwrite these
        }
    }
}

// Triangles that intersect many others. The numbers of pairs with one first triangle (a row) are around 64 and 2,048,
// the largest rows that are sorted at once and in one part; longer rows are sorted in several parts.
TEST(CudaLaunch, thousands_of_pairs_of_one_triangle_are_sorted) {
    Soup<float> soup;
    const auto add = [&](std::array<float, 3> a, std::array<float, 3> b, std::array<float, 3> c) {
        const auto v = static_cast<std::int32_t>(soup.vertices.size());
        for (const auto& p : {a, b, c}) soup.vertices.push_back(p);
        soup.triangles.push_back({v, v + 1, v + 2});
    };
    const std::array counts{64, 65, 2048, 2049, 4200};
    const auto height = [](std::size_t k) { return 2 * static_cast<float>(k); };
    for (std::size_t k = 0; k < 5; ++k) add({-9, -9, height(k)}, {30, -9, height(k)}, {-9, 30, height(k)});
    for (int i = 0; i < 4200; ++i)
        for (std::size_t k = 0; k < 5; ++k) {
            if (i >= counts[k]) continue;
            const float x = static_cast<float>(i % 70) / 70, y = static_cast<float>(i / 70) / 70, z = height(k);
            add({x, y, z - 0.5f}, {x, y, z + 0.5f}, {x + 1e-3f, y, z + 0.5f});
        }
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    const Intersections& expected = cpu.find(soup.view());
    for (std::size_t k = 0; k < 5; ++k) ASSERT_EQ(expected.offsets[k + 1] - expected.offsets[k], counts[k]);
    const DeviceMesh device(soup.view());
    EXPECT_TRUE(shows(cuda.launch(device.view()).wait(), soup.view(), nullptr, expected));
    Detector chunked({.backend = Backend::cuda, .memory_limit = 2'000'000});
    EXPECT_TRUE(same_result(chunked.find(device.view()), expected));
}

// A search in chunks under a memory limit, with one cluster whose sweep has more units of work than a chunk can hold.
TEST(CudaLaunch, one_large_cluster_under_a_small_memory_limit_gives_all_pairs) {
    Soup<float> soup = random_soup(6000, 0.01);
    for (std::size_t v = 0; v < soup.vertices.size(); ++v)
        soup.vertices[v][0] = 3 * soup.vertices[v][0] + (v % 3 ? 0 : 1);
    const DeviceMesh device(soup.view());
    Detector cpu({.backend = Backend::cpu});
    const Options options{.backend = Backend::cuda, .memory_limit = 1'900'000, .leaf_size = 100'000};
    EXPECT_TRUE(same_result(Detector(options).find(device.view()), cpu.find(soup.view())));
    EXPECT_TRUE(Detector(options).any(device.view()));
}

// Scenes with no pair, with one pair among many triangles, and with thousands of pairs; searched at once, and in chunks
// under a memory limit.
TEST(CudaLaunch, any_reports_whether_anything_collides) {
    Soup<float> soup = random_soup(1000, 1e-4);
    const DeviceMesh apart(soup.view());
    for (int k = 0; k < 3; ++k)
        soup.vertices[static_cast<std::size_t>(3 * 250 + k)] = soup.vertices[static_cast<std::size_t>(3 * 20 + k)];
    const DeviceMesh one_pair(soup.view()), many(random_soup(1000, 0.5).view());
    for (const std::int64_t limit : {0, 400'000}) {
        for (const int leaf_size : {3000, 200, 10}) {
            if (limit && leaf_size < 200) continue;  // the bins of stage `sort` for so many leaves need more memory
            SCOPED_TRACE(testing::Message() << "leaves of " << leaf_size << ", limit " << limit);
            Detector cuda({.backend = Backend::cuda, .memory_limit = limit, .leaf_size = leaf_size});
            for (int repeat = 0; repeat < 2; ++repeat) {
                EXPECT_FALSE(cuda.any(apart.view()));
                EXPECT_TRUE(cuda.any(one_pair.view()));
                EXPECT_TRUE(cuda.any(many.view()));
                EXPECT_EQ(cuda.find(one_pair.view()).pairs.size(), 1u);
                EXPECT_FALSE(cuda.any(apart.view()));
            }
        }
    }
}

TEST(CudaLaunch, two_alternating_buffers_match_the_cpu) {
    const io::TriangleMesh meshes[2] = {cloth(600, 80), cloth(600, 93)};
    const DeviceMesh buffers[2] = {DeviceMesh(meshes[0].view()), DeviceMesh(meshes[1].view())};
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    for (int frame = 0; frame < 6; ++frame) {
        const auto launched = cuda.launch(buffers[frame % 2].view());
        const MeshView mesh = meshes[frame % 2].view();
        EXPECT_TRUE(shows(launched.wait(), mesh, nullptr, cpu.find(mesh))) << "frame " << frame;
    }
}

TEST(CudaLaunch, results_match_the_cpu_while_excluded_groups_change) {
    io::TriangleMesh mesh = cloth(600, 93);
    mesh.groups.clear();
    for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) mesh.groups.push_back(t % 3);
    const DeviceMesh device(mesh.view());
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    const std::array some{GroupPair{0, 1}, GroupPair{2, 2}}, others{GroupPair{1, 2}, GroupPair{0, 0}};
    const std::array fewer{GroupPair{1, 2}};
    const std::span<const GroupPair> none, lists[] = {some, some, others, fewer, none, fewer, some};
    std::vector<std::size_t> counts;
    for (const auto& excluded : lists) {
        const IntersectionQuery query{.filter = {.excluded_groups = {excluded.begin(), excluded.end()}}};
        const Intersections& expected = cpu.find(mesh.view(), query);
        counts.push_back(expected.pairs.size());
        EXPECT_TRUE(shows(cuda.launch(device.view(), query).wait(), mesh.view(), nullptr, expected))
            << "list " << counts.size();
        const Part part = cpu.partition(mesh.view(), {}, 2)[0];
        EXPECT_TRUE(same_result(cuda.find(part, query), cpu.find(part, query)));
    }
    EXPECT_NE(counts[1], counts[2]);
    EXPECT_LT(counts[2], counts[3]);
    EXPECT_LT(counts[3], counts[4]);
}

TEST(CudaLaunch, download_is_rejected_before_wait_and_after_a_later_call) {
    const io::TriangleMesh mesh = cloth(300, 93);
    const DeviceMesh device(mesh.view());
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    const std::vector<std::function<void()>> later_calls{
        [&] { cuda.find(mesh.view()); },
        [&] { cuda.any(device.view()); },
        [&] { EXPECT_THROW(cuda.launch(mesh.view()), Error); },
        [&] { EXPECT_THROW(cuda.find(Part{}), Error); },
        [&] { EXPECT_THROW(cuda.partition(mesh.view(), {}, 0), Error); },
        [&] { cuda.launch(device.view()); },
    };
    for (const auto& call : later_calls) {
        const auto launched = cuda.launch(device.view());
        EXPECT_THROW(launched.download(), Error) << "nobody has waited for it";
        launched.wait();
        EXPECT_TRUE(same_result(launched.download(), cpu.find(mesh.view())));
        EXPECT_TRUE(same_result(launched.download(), cpu.find(mesh.view())));
        call();
        EXPECT_THROW(launched.download(), Error);
    }
}

TEST(CudaLaunch, two_meshes_match_the_cpu) {
    const io::TriangleMesh mesh = cloth(700);
    const Halves half(mesh.view());
    const DeviceMesh a(half.a), b(half.b);
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    for (int repeat = 0; repeat < 3; ++repeat) {
        EXPECT_TRUE(shows(cuda.launch({a.view(), b.view()}).wait(), half.a, &half.b, cpu.find({half.a, half.b})));
    }
}

TEST(CudaLaunch, find_makes_wait_of_launches_in_flight_an_error) {
    const io::TriangleMesh first = cloth(300), second = cloth(500);
    const DeviceMesh device_first(first.view()), device_second(second.view());
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    const auto older = cuda.launch(device_first.view()), newer = cuda.launch(device_first.view());
    EXPECT_TRUE(same_result(cuda.find(second.view()), cpu.find(second.view())));
    EXPECT_THROW(older.wait(), Error);
    EXPECT_THROW(newer.wait(), Error);
    EXPECT_TRUE(shows(cuda.launch(device_second.view()).wait(), second.view(), nullptr, cpu.find(second.view())));
    cuda.launch(device_first.view());
}

/// RAII wrapper of a stream.
struct OwnStream {
    cudaStream_t stream = nullptr;
    OwnStream() { check(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking)); }
    ~OwnStream() { cudaStreamDestroy(stream); }
    MeshView on(MeshView mesh) const {
        mesh.stream = stream;
        return mesh;
    }
};

// Each wait() returns the result of the oldest launch, on one stream or on two; the result stays valid until the second
// launch after its own.
TEST(CudaLaunch, two_frames_in_flight_match_the_cpu) {
    for (const int streams : {1, 2}) {
        for (const int leaf_size : {3000, 60}) {
            for (const bool contacts : {false, true}) {
                SCOPED_TRACE(testing::Message() << streams << " streams, leaves of " << leaf_size << contacts);
                const IntersectionQuery query{.output = contacts ? Output::contacts : Output::pairs};
                const OwnStream stream[2];
                std::vector<io::TriangleMesh> meshes;
                std::vector<DeviceMesh> buffers;
                std::vector<MeshView> views;
                for (std::size_t frame = 0; frame < 8; ++frame) {
                    meshes.push_back(cloth(600, 60 + 4 * static_cast<int>(frame)));
                    buffers.emplace_back(meshes.back().view());
                    views.push_back(stream[streams == 2 ? frame % 2 : 0].on(buffers.back().view()));
                }
                Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda, .leaf_size = leaf_size});
                const auto expect_right = [&](const DeviceIntersections& found, std::size_t frame) {
                    const Intersections& expected = cpu.find(meshes[frame].view(), query);
                    EXPECT_TRUE(shows(found, views[frame], nullptr, expected)) << "frame " << frame;
                };
                std::vector launched{cuda.launch(views[0], query)};
                for (std::size_t frame = 1; frame < 8; ++frame) {
                    launched.push_back(cuda.launch(views[frame], query));
                    const DeviceIntersections& found = launched[frame - 1].wait();
                    expect_right(found, frame - 1);
                    EXPECT_TRUE(same_result(launched[frame - 1].download(), cpu.find(meshes[frame - 1].view(), query)));
                }
                const DeviceIntersections& last = launched[7].wait();
                const auto next = cuda.launch(views[0], query);
                expect_right(last, 7);
                next.wait();
                expect_right(last, 7);
            }
        }
    }
}

// The wait() of the first launch decides the pairs that its pass (one run of all stages) left undecided, although the
// second pass has already reused the lists. Both results are right.
TEST(CudaLaunch, two_hard_soups_in_flight_match_the_cpu) {
    const std::vector<NamedMesh> scenes = hard_soups();
    const IntersectionQuery query{.output = Output::contacts};
    Detector cpu({.backend = Backend::cpu});
    Detector cuda({.backend = Backend::cuda, .leaf_size = 30});
    const OwnStream stream[2];
    int again = 0;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        for (const std::size_t other : {i, (i + 1) % scenes.size(), (i + 5) % scenes.size()}) {
            if (sanitized && other != (i + 1) % scenes.size()) continue;  // sanitizers are slow
            SCOPED_TRACE(scenes[i].name + " and " + scenes[other].name);
            const DeviceMesh first(scenes[i].mesh.view()), second(scenes[other].mesh.view());
            const auto older = cuda.launch(stream[0].on(first.view()), query);
            const auto newer = cuda.launch(stream[1].on(second.view()), {.weld = true});
            const DeviceIntersections found = older.wait();
            if (found.statistics.rational_tests > 0) {
                ++again;
                EXPECT_EQ(cudaStreamQuery(stream[1].stream), cudaSuccess) << "it ran again while its lists were in use";
            }
            EXPECT_TRUE(shows(found, first.view(), nullptr, cpu.find(scenes[i].mesh.view(), query)));
            EXPECT_TRUE(
                shows(newer.wait(), second.view(), nullptr, cpu.find(scenes[other].mesh.view(), {.weld = true})));
        }
    }
    EXPECT_GT(again, 0);
}

TEST(CudaLaunch, growing_results_of_frames_in_flight_match_the_cpu) {
    constexpr int n = 1500;
    const Soup<float> soups[] = {random_soup(n, 1e-3), random_soup(n, 0.6, 2), random_soup(n, 0.9, 3)};
    const int frames[] = {0, 0, 0, 1, 2, 0, 2, 2, 1, 0, 0};
    std::vector<DeviceMesh> devices;
    for (const Soup<float>& soup : soups) devices.emplace_back(soup.view());
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    std::vector<Intersections> expected;
    for (const Soup<float>& soup : soups) expected.push_back(cpu.find(soup.view()));
    ASSERT_GT(expected[1].pairs.size(), 3u * n);
    ASSERT_GT(expected[2].pairs.size(), expected[1].pairs.size() * 5 / 4);
    std::vector<LaunchTicket<IntersectionQuery>> launched;
    for (std::size_t frame = 0; frame < std::size(frames); ++frame) {
        launched.push_back(cuda.launch(devices[static_cast<std::size_t>(frames[frame])].view()));
        if (frame == 0) continue;
        const auto before = static_cast<std::size_t>(frames[frame - 1]);
        EXPECT_TRUE(shows(launched[frame - 1].wait(), soups[before].view(), nullptr, expected[before]))
            << "frame " << frame - 1;
    }
    EXPECT_TRUE(shows(launched.back().wait(), soups[0].view(), nullptr, expected[0]));
}

// All passes of a detector use the same lists. So a pass begins only after all earlier passes have ended, on any
// stream; the same is true of operations that move the lists, and of repeated passes.
TEST(CudaLaunch, launches_on_two_streams_end_in_order_and_list_changes_wait_for_them) {
    constexpr int n = 1500;
    const Soup<float> sparse = random_soup(n, 1e-3), dense = random_soup(n, 0.6, 2), more = random_soup(2 * n, 1e-3);
    DeviceMesh first(sparse.view());
    const DeviceMesh second(sparse.view()), larger(more.view());
    const OwnStream stream[2];
    Detector cuda({.backend = Backend::cuda});
    const auto is_done = [&](int i) { return cudaStreamQuery(stream[i].stream) == cudaSuccess; };
    for (int frame = 0; frame < 6; ++frame) {
        const auto older = cuda.launch(stream[0].on(first.view())), newer = cuda.launch(stream[1].on(second.view()));
        check(cudaStreamSynchronize(stream[1].stream));
        EXPECT_TRUE(is_done(0)) << "frame " << frame;
        older.wait();
        newer.wait();
    }
    first.set_vertices(dense.view());
    auto older = cuda.launch(stream[0].on(first.view())), newer = cuda.launch(stream[1].on(second.view()));
    EXPECT_GT(older.wait().count, n);
    EXPECT_TRUE(is_done(1)) << "when lists of the first grow";
    newer.wait();
    older = cuda.launch(stream[0].on(first.view()));
    newer = cuda.launch(stream[1].on(larger.view()));
    EXPECT_TRUE(is_done(0)) << "when lists are laid out for another scene";
    older.wait();
    newer.wait();
}

TEST(CudaLaunch, third_launch_in_flight_is_rejected) {
    const io::TriangleMesh meshes[2] = {cloth(300, 93), cloth(500, 93)};
    const DeviceMesh first(meshes[0].view()), second(meshes[1].view());
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    for (int turn = 0; turn < 3; ++turn) {
        const auto older = cuda.launch(first.view()), newer = cuda.launch(second.view());
        EXPECT_STREQ(error_of([&] { cuda.launch(first.view()); }).what(),
                     "two launches are in flight; call wait() before the next launch");
        EXPECT_THROW(cuda.launch(meshes[0].view()), Error);
        EXPECT_TRUE(shows(older.wait(), first.view(), nullptr, cpu.find(meshes[0].view())));
        EXPECT_TRUE(shows(newer.wait(), second.view(), nullptr, cpu.find(meshes[1].view())));
    }
}

constexpr const char* nothing_to_wait_for = "wait() is too late: another call of the detector came after this launch";

TEST(CudaLaunch, wait_is_allowed_once_and_in_order) {
    const io::TriangleMesh meshes[2] = {cloth(300, 93), cloth(500, 93)};
    const DeviceMesh first(meshes[0].view()), second(meshes[1].view());
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    const auto message_of = [](const LaunchTicket<IntersectionQuery>& ticket) {
        const Error error = error_of([&] { ticket.wait(); });
        EXPECT_EQ(error.code, ErrorCode::invalid_argument);
        return std::string(error.what());
    };
    for (int turn = 0; turn < 2; ++turn) {
        const auto older = cuda.launch(first.view()), newer = cuda.launch(second.view()), copy = newer;
        EXPECT_EQ(message_of(newer), "an older launch is in flight; call wait() in the order of the launches");
        EXPECT_TRUE(shows(older.wait(), first.view(), nullptr, cpu.find(meshes[0].view())));
        EXPECT_TRUE(same_result(older.download(), cpu.find(meshes[0].view())));
        EXPECT_THROW(newer.download(), Error) << "nobody has waited for it";
        EXPECT_EQ(message_of(older), nothing_to_wait_for);
        EXPECT_TRUE(shows(copy.wait(), second.view(), nullptr, cpu.find(meshes[1].view())));
        EXPECT_EQ(message_of(newer), "wait() has already been called for this launch");
        EXPECT_THROW(older.download(), Error) << "another call has come";
    }
    for (const bool refused : {false, true}) {
        const auto launched = cuda.launch(first.view());
        if (refused)
            EXPECT_THROW(cuda.find(Part{}), Error);
        else
            cuda.find(second.view());
        EXPECT_EQ(message_of(launched), nothing_to_wait_for);
    }
}

TEST(CudaLaunch, wait_after_a_cancelled_wait_gives_the_result) {
    const io::TriangleMesh mesh = cloth(300, 93);
    const DeviceMesh device(mesh.view());
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    const auto launched = cuda.launch(device.view());
    std::stop_source stop;
    stop.request_stop();
    EXPECT_EQ(error_of([&] { launched.wait(stop.get_token()); }).code, ErrorCode::cancelled);
    EXPECT_TRUE(shows(launched.wait(), mesh.view(), nullptr, cpu.find(mesh.view())));
}

TEST(CudaLaunch, wait_gives_the_result_after_the_detector_was_moved) {
    const io::TriangleMesh mesh = cloth(300, 93);
    const DeviceMesh device(mesh.view());
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    const auto launched = cuda.launch(device.view());
    const Detector moved = std::move(cuda);
    EXPECT_TRUE(shows(launched.wait(), mesh.view(), nullptr, cpu.find(mesh.view())));
    EXPECT_TRUE(same_result(launched.download(), cpu.find(mesh.view())));
}

// Bad input of one launch does not affect the other.
TEST(CudaLaunch, bad_input_fails_only_its_own_launch) {
    const Soup<float> good = random_soup(200, 0.2);
    Soup<float> bad = good;
    bad.vertices[17][1] = std::numeric_limits<float>::infinity();
    const DeviceMesh device[2] = {DeviceMesh(good.view()), DeviceMesh(bad.view())};
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    const Intersections& expected = cpu.find(good.view());
    const int frames[] = {0, 0, 0, 1, 0, 1, 1, 0, 0, 0};
    std::vector<LaunchTicket<IntersectionQuery>> launched;
    const auto expect_result = [&](std::size_t frame) {
        if (frames[frame])
            EXPECT_STREQ(error_of([&] { launched[frame].wait(); }).what(), "vertex 17 is not finite");
        else
            EXPECT_TRUE(shows(launched[frame].wait(), good.view(), nullptr, expected));
    };
    for (std::size_t frame = 0; frame < std::size(frames); ++frame) {
        launched.push_back(cuda.launch(device[frames[frame]].view()));
        if (frame == 0) continue;
        expect_result(frame - 1);
        EXPECT_STREQ(error_of([&] { launched[frame - 1].wait(); }).what(), nothing_to_wait_for);
    }
    expect_result(std::size(frames) - 1);
}

TEST(CudaLaunch, second_frame_in_flight_needs_no_higher_memory_limit) {
    const io::TriangleMesh meshes[2] = {cloth(600, 80), cloth(600, 93)};
    const DeviceMesh devices[2] = {DeviceMesh(meshes[0].view()), DeviceMesh(meshes[1].view())};
    Detector cpu({.backend = Backend::cpu});
    const std::vector<Intersections> expected{cpu.find(meshes[0].view()), cpu.find(meshes[1].view())};
    Detector unlimited({.backend = Backend::cuda});
    const std::int64_t all = unlimited.find(devices[1].view()).statistics.peak_memory_bytes;
    // Returns the number of frames with results under a limit. At each wait(), `ahead` later launches are in flight.
    const auto completed_frames = [&](std::int64_t limit, std::size_t ahead) {
        SCOPED_TRACE(testing::Message() << limit << " bytes");
        Detector cuda({.backend = Backend::cuda, .memory_limit = limit});
        std::vector<LaunchTicket<IntersectionQuery>> launched;
        std::size_t completed = 0;
        try {
            for (std::size_t frame = 0; frame < 6; ++frame) {
                launched.push_back(cuda.launch(devices[frame % 2].view()));
                if (frame < ahead) continue;
                const std::size_t which = completed % 2;
                EXPECT_TRUE(shows(launched[completed].wait(), meshes[which].view(), nullptr, expected[which]))
                    << completed;
                ++completed;
            }
        } catch (const Error& error) {
            EXPECT_EQ(error.code, ErrorCode::memory_limit) << error.what();
        }
        return completed;
    };
    std::size_t most = 0, least = 6;
    for (std::int64_t limit = 2 * all; limit > 100'000; limit -= limit / 6) {
        const std::size_t one = completed_frames(limit, 0), two = completed_frames(limit, 1);
        EXPECT_EQ(two == 5, one == 6) << limit;
        most = std::max(most, two);
        least = std::min(least, two);
    }
    EXPECT_EQ(most, 5u);
    EXPECT_EQ(least, 0u);
}

TEST(CudaLaunch, empty_meshes_match_the_cpu) {
    const io::TriangleMesh mesh = cloth(300, 93);
    const DeviceMesh nothing{MeshView()}, something(mesh.view());
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    for (int repeat = 0; repeat < 3; ++repeat)
        EXPECT_TRUE(shows(cuda.launch(nothing.view()).wait(), MeshView(), nullptr, cpu.find(MeshView())));
    const MeshView host_of[2] = {MeshView(), mesh.view()};
    const MeshView device_of[2] = {nothing.view(), something.view()};
    for (const int first : {0, 1}) {
        for (int repeat = 0; repeat < 3; ++repeat) {
            const IntersectionQuery query{.output = Output::contacts, .weld = repeat > 0};
            EXPECT_TRUE(shows(cuda.launch({device_of[first], device_of[1 - first]}, query).wait(), host_of[first],
                              &host_of[1 - first], cpu.find({host_of[first], host_of[1 - first]}, query)));
        }
    }
}

TEST(CudaLaunch, calls_leave_the_capture_of_another_thread_valid) {
    const io::TriangleMesh mesh = cloth(300, 93);
    const Intersections expected = Detector({.backend = Backend::cpu}).find(mesh.view());
    const DeviceMesh device(mesh.view());
    const DeviceBytes bytes(std::vector<std::byte>(4));
    cudaStream_t stream;
    check(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking));
    check(cudaStreamBeginCapture(stream, cudaStreamCaptureModeGlobal));
    check(cudaMemsetAsync(bytes.data(), 0, 4, stream));
    std::thread([&] {
        Detector cuda({.backend = Backend::cuda});
        EXPECT_TRUE(same_result(cuda.find(mesh.view()), expected));
        for (int frame = 0; frame < 4; ++frame) {
            const auto launched = cuda.launch(device.view());
            EXPECT_EQ(launched.wait().count, static_cast<std::int64_t>(expected.pairs.size()));
            EXPECT_TRUE(same_result(launched.download(), expected));
        }
        cuda.launch(device.view());  // the detector's destructor waits for it
    }).join();
    cudaGraph_t graph = nullptr;
    EXPECT_EQ(cudaStreamEndCapture(stream, &graph), cudaSuccess);
    if (graph) check(cudaGraphDestroy(graph));
    check(cudaStreamDestroy(stream));
}

TEST(CudaLaunch, launches_on_default_streams_match_the_cpu_while_another_thread_captures) {
    const io::TriangleMesh mesh = cloth(300, 93);
    const Intersections expected = Detector({.backend = Backend::cpu}).find(mesh.view());
    const DeviceMesh device(mesh.view());
    cudaStream_t captured;
    check(cudaStreamCreateWithFlags(&captured, cudaStreamNonBlocking));
    for (const bool captures : {false, true}) {
        for (const cudaStream_t stream : {cudaStream_t{}, cudaStreamLegacy, cudaStreamPerThread}) {
            if (captures) check(cudaStreamBeginCapture(captured, cudaStreamCaptureModeGlobal));
            std::thread([&] {
                MeshView view = device.view();
                view.stream = stream;
                Detector cuda({.backend = Backend::cuda});
                EXPECT_TRUE(same_result(cuda.find(view), expected));
                for (int frame = 0; frame < 3; ++frame)
                    EXPECT_TRUE(shows(cuda.launch(view).wait(), view, nullptr, expected));
            }).join();
            if (!captures) continue;
            cudaGraph_t graph = nullptr;
            EXPECT_EQ(cudaStreamEndCapture(captured, &graph), cudaSuccess);
            if (graph) check(cudaGraphDestroy(graph));
        }
    }
    check(cudaStreamDestroy(captured));
}

TEST(CudaLaunch, calls_on_a_capturing_stream_without_warm_up_are_rejected) {
    const io::TriangleMesh mesh = cloth(300, 93);
    const DeviceMesh device(mesh.view());
    const DeviceBytes bytes(std::vector<std::byte>(4));
    cudaStream_t stream;
    check(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking));
    check(cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal));
    check(cudaMemsetAsync(bytes.data(), 0, 4, stream));
    MeshView view = device.view();
    view.stream = stream;
    Detector cuda({.backend = Backend::cuda});
    EXPECT_THROW(cuda.launch(view), Error);
    EXPECT_THROW(cuda.find(view), Error);
    EXPECT_THROW(cuda.launch({device.view(), view}), Error);
    cudaGraph_t graph = nullptr;
    EXPECT_EQ(cudaStreamEndCapture(stream, &graph), cudaSuccess);
    if (graph) check(cudaGraphDestroy(graph));
    EXPECT_GT(cuda.launch(view).wait().count, 0);
    check(cudaStreamDestroy(stream));
}

TEST(CudaLaunch, wait_throws_if_a_triangle_names_a_missing_vertex) {
    io::TriangleMesh mesh = cloth(300);
    mesh.triangles[5] = 1'000'000;
    const DeviceMesh bad(mesh.view());
    Detector cuda({.backend = Backend::cuda});
    const auto launched = cuda.launch(bad.view());
    EXPECT_THROW(launched.wait(), Error);
    const io::TriangleMesh good = cloth(300);
    const DeviceMesh device(good.view());
    EXPECT_EQ(cuda.launch(device.view()).wait().count,
              static_cast<std::int64_t>(Detector().find(good.view()).pairs.size()));
}

TEST(CudaLaunch, limited_launch_gives_same_result_or_names_larger_limit) {
    const io::TriangleMesh mesh = cloth(600);
    const DeviceMesh device(mesh.view());
    const IntersectionQuery query{.output = Output::contacts};
    Detector cpu({.backend = Backend::cpu});
    const Intersections& expected = cpu.find(mesh.view(), query);
    const auto shows_all = [&](Detector& cuda) {
        const auto launched = cuda.launch(device.view(), query);
        EXPECT_TRUE(shows(launched.wait(), mesh.view(), nullptr, expected));
        EXPECT_TRUE(same_result(launched.download(), expected));
    };
    Detector unlimited({.backend = Backend::cuda});
    shows_all(unlimited);
    int failures = 0;
    for (std::int64_t limit = unlimited.find(device.view(), query).statistics.peak_memory_bytes; limit > 1'000;
         limit -= limit / 5) {
        SCOPED_TRACE(testing::Message() << limit << " bytes");
        Detector limited({.backend = Backend::cuda, .memory_limit = limit});
        try {
            shows_all(limited);
            shows_all(limited);
        } catch (const Error& error) {
            ++failures;
            ASSERT_EQ(error.code, ErrorCode::memory_limit) << error.what();
            ASSERT_GT(error.bytes_needed, limit);
            sufficient_limit({.backend = Backend::cuda, .memory_limit = limit}, shows_all);
        }
    }
    EXPECT_GT(failures, 2);
}

TEST(CudaLaunch, counting_ends_when_pairs_alone_exceed_the_limit) {
    const Soup<float> soup = random_soup(2000, 1);
    const DeviceMesh device(soup.view());
    Detector unlimited({.backend = Backend::cpu});
    const auto pairs = static_cast<std::int64_t>(unlimited.find(soup.view()).pairs.size());
    ASSERT_GT(pairs, 50'000);
    const std::int64_t limit = 12 * pairs / 2, all = 12 * pairs;
    Detector cuda({.backend = Backend::cuda, .memory_limit = limit});
    const Error error = error_of([&] { cuda.launch(device.view()).wait(); });
    EXPECT_GT(error.bytes_needed, limit);
    EXPECT_LT(error.bytes_needed, all) << "it was counted on";
}

}  // namespace
}  // namespace crumple::test
