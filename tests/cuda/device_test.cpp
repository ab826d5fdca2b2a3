// Meshes and answers in device memory. Plain CUDA: the CPU plays the device, or a device is there.

#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>
#include <vector>

#include "agreement/compare.h"
#include "agreement/hard_soups.h"
#include "crumple/error.h"
#include "cuda/device_mesh.h"
#include "scenes/scenes.h"

namespace crumple::test {
namespace {

io::TriangleMesh cloth(int triangles, int frame = 40) {
    return scenes::make("cloth", {.triangles = triangles, .frame = frame});
}

/// Every other triangle of a soup, and the rest, over the same vertices.
std::array<MeshView, 2> halves(const MeshView& mesh) {
    std::array<MeshView, 2> half{mesh, mesh};
    for (std::size_t side = 0; side < 2; ++side) {
        TriangleView& t = half[side].triangles;
        t.data = static_cast<const char*>(t.data) + static_cast<std::int64_t>(side) * t.row_stride;
        t.rows = (mesh.triangles.rows + 1 - static_cast<std::int64_t>(side)) / 2;
        t.row_stride *= 2;
        half[side].groups = {};
    }
    return half;
}

testing::AssertionResult shows(const DeviceCollisions& found, const MeshView& a, const MeshView* b,
                               const Collisions& expected) {
    const auto same = [](const auto& device, const auto& host, const char* what) {
        return std::equal(device.begin(), device.end(), host.begin(), host.end())
                   ? testing::AssertionSuccess()
                   : testing::AssertionFailure() << what << " differ";
    };
    const std::vector<Pair> pairs = to_host(found.pairs, found.pair_count);
    testing::AssertionResult result = same_pairs(pairs, expected.pairs.span());
    if (result) result = same(to_host(found.offsets, a.triangles.rows + 1), expected.offsets, "offsets");
    if (result) result = same(to_host(found.hit, a.triangles.rows), expected.hit, "hit flags");
    if (result && b) result = same(to_host(found.hit_second, b->triangles.rows), expected.hit_second, "second flags");
    if (!result || expected.contacts.offsets.empty()) return result;
    result = same(to_host(found.contact_kinds, found.pair_count), expected.contacts.kinds, "kinds");
    if (result)
        result =
            same(to_host(found.contact_offsets, found.pair_count + 1), expected.contacts.offsets, "contact offsets");
    if (result)
        result = same(to_host(found.contact_points, found.contact_point_count), expected.contacts.points, "points");
    return result;
}

TEST(CudaDevice, takes_meshes_of_every_layout) {
    for (const NamedMesh& scene : hard_soups()) {
        SCOPED_TRACE(scene.name);
        const MeshView host = scene.mesh.view();
        const DeviceMesh device(host);
        Detector reference({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
        for (const bool weld : {false, true}) {
            const Query query{.weld = weld, .contacts = !weld};
            EXPECT_TRUE(same_answer(cuda.find_self(device.view(), query), reference.find_self(host, query)));
        }
        EXPECT_EQ(cuda.has_collision(device.view()), reference.has_collision(host));
    }
}

TEST(CudaDevice, takes_int64_indices_and_strided_vertices) {
    const io::TriangleMesh mesh = cloth(600);
    MeshView host = mesh.view();
    host.groups = {};
    std::vector<std::int64_t> wide(static_cast<std::size_t>(3 * host.triangles.rows));
    for (std::size_t i = 0; i < wide.size(); ++i) wide[i] = static_cast<const std::int32_t*>(host.triangles.data)[i];
    MeshView with_wide = host;
    with_wide.triangles = rows_of_three(wide.data(), host.triangles.rows);
    const DeviceMesh device(with_wide);
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    EXPECT_TRUE(same_answer(cuda.find_self(device.view()), cpu.find_self(host)));

    MeshView every_other = device.view(), host_every_other = host;
    for (MeshView* view : {&every_other, &host_every_other}) {
        view->triangles.rows /= 2;
        view->triangles.row_stride *= 2;
    }
    EXPECT_TRUE(same_answer(cuda.find_self(every_other), cpu.find_self(host_every_other)));
}

TEST(CudaDevice, compares_two_meshes_with_groups_and_parts) {
    const io::TriangleMesh mesh = cloth(800);
    const auto half = halves(mesh.view());
    const MeshView &a = half[0], &b = half[1];
    std::vector<std::int32_t> groups(static_cast<std::size_t>(a.triangles.rows));
    for (std::size_t i = 0; i < groups.size(); ++i) groups[i] = static_cast<std::int32_t>(i % 3);
    MeshView grouped = a;
    grouped.groups = groups;
    const DeviceMesh device_a(grouped), device_b(b);
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    for (const Wanted wanted : {Wanted::both, Wanted::between, Wanted::within}) {
        const Query query{.weld = true, .wanted = wanted};
        EXPECT_TRUE(same_answer(cuda.find_between(device_a.view(), device_b.view(), query),
                                cpu.find_between(grouped, b, query)));
    }
    for (Part& part : cpu.partition(grouped, b, 3)) {
        const auto same = [&] {
            return same_answer(cuda.find_between(device_a.view(), device_b.view(), part),
                               cpu.find_between(grouped, b, part));
        };
        EXPECT_TRUE(same());
        part.triangles.clear();
        EXPECT_TRUE(same());  // no triangle of the first mesh is a member
        part.triangles_second.clear();
        EXPECT_TRUE(same());  // members are found again
    }
}

TEST(CudaDevice, splits_a_scene_64_ways_and_the_same_triangles_63_ways_between_two_meshes) {
    const io::TriangleMesh mesh = cloth(800);
    const MeshView host = mesh.view();
    const auto half = halves(host);
    const DeviceMesh whole(host), a(half[0]), b(half[1]);
    Detector cpu({.backend = Backend::cpu});
    for (const int leaf_size : {3000, 3}) {  // one level and two
        Detector cuda({.backend = Backend::cuda, .clusters = 64, .leaf_size = leaf_size});
        for (int turn = 0; turn < 2; ++turn) {
            const Collisions& self = cuda.find_self(whole.view());
            EXPECT_EQ(self.statistics.clusters, 64);
            EXPECT_TRUE(same_answer(self, cpu.find_self(host)));
            const Collisions& between = cuda.find_between(a.view(), b.view());
            EXPECT_EQ(between.statistics.clusters, 63);
            EXPECT_TRUE(same_answer(between, cpu.find_between(half[0], half[1])));
        }
    }
}

TEST(CudaDevice, cuts_a_scene_into_the_parts_of_the_host) {
    const io::TriangleMesh mesh = cloth(1501);
    const auto half = halves(mesh.view());
    const DeviceMesh device(mesh.view()), device_a(half[0]), device_b(half[1]);
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    const auto expect_same = [](const std::vector<Part>& found, const std::vector<Part>& expected) {
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t k = 0; k < found.size(); ++k) {
            EXPECT_EQ(found[k].index, expected[k].index);
            EXPECT_EQ(found[k].centres, expected[k].centres);
            EXPECT_EQ(found[k].triangles, expected[k].triangles);
            EXPECT_EQ(found[k].triangles_second, expected[k].triangles_second);
        }
    };
    for (const int count : {1, 3, 64}) {
        expect_same(cuda.partition(device.view(), count), cpu.partition(mesh.view(), count));
        expect_same(cuda.partition(device_a.view(), device_b.view(), count), cpu.partition(half[0], half[1], count));
    }
    expect_same(cuda.partition(DeviceMesh(MeshView()).view(), 2), cpu.partition(MeshView(), 2));
    std::vector<Pair> joined;
    for (const Part& part : cuda.partition(device.view(), 5))
        for (const Pair& pair : cuda.find_self(device.view(), part).pairs) joined.push_back(pair);
    std::sort(joined.begin(), joined.end());
    const Collisions& whole = cpu.find_self(mesh.view());
    EXPECT_TRUE(std::equal(joined.begin(), joined.end(), whole.pairs.begin(), whole.pairs.end()));
}

TEST(CudaDevice, names_what_is_wrong_on_the_device) {
    io::TriangleMesh mesh = cloth(300);
    const auto message = [&](const MeshView& view) -> std::string {
        const DeviceMesh device(view);
        Detector cuda({.backend = Backend::cuda});
        try {
            cuda.find_self(device.view());
        } catch (const Error& error) {
            return error.what();
        }
        return "no error";
    };
    auto& indices = mesh.triangles;
    const auto vertices = std::to_string(mesh.view().vertices.rows);
    indices[3 * 7 + 1] = -5;
    EXPECT_EQ(message(mesh.view()), "triangle 7 names vertex -5 of " + vertices);
    indices[3 * 4] = static_cast<std::int32_t>(mesh.view().vertices.rows);
    EXPECT_EQ(message(mesh.view()), "triangle 4 names vertex " + vertices + " of " + vertices);
    std::visit([](auto& xyz) { xyz[3 * 17 + 2] = std::numeric_limits<float>::infinity(); }, mesh.vertices);
    EXPECT_EQ(message(mesh.view()), "vertex 17 is not finite");

    // A simulation that has blown up: each NaN differs from all others, which must not make welding slow.
    const std::vector<std::array<float, 3>> all_nan(100'000, {NAN, 0, 0});
    const std::vector<std::array<std::int32_t, 3>> one{{0, 1, 2}};
    const DeviceMesh blown_up(MeshView(all_nan, one));
    try {
        Detector({.backend = Backend::cuda}).find_self(blown_up.view(), Query{.weld = true});
        ADD_FAILURE() << "no error";
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(), "vertex 0 is not finite");
    }
}

TEST(CudaDevice, launches_frames_of_a_simulation) {
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
            const Query query{.contacts = frame % 24 == 0};
            cuda.launch_self(view, query);
            const DeviceCollisions& found = cuda.wait();
            const Collisions& expected = cpu.find_self(mesh.view(), query);
            pairs += found.pair_count;
            ASSERT_TRUE(shows(found, view, nullptr, expected)) << "frame " << frame;
            ASSERT_TRUE(same_answer(cuda.download(), expected)) << "frame " << frame;
        }
    }
    EXPECT_GT(pairs, 100);
    check(cudaStreamDestroy(stream));
}

TEST(CudaDevice, launches_from_two_buffers_in_turn) {
    const io::TriangleMesh meshes[2] = {cloth(600, 80), cloth(600, 93)};
    const DeviceMesh buffers[2] = {DeviceMesh(meshes[0].view()), DeviceMesh(meshes[1].view())};
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    for (int frame = 0; frame < 6; ++frame) {
        cuda.launch_self(buffers[frame % 2].view());
        const MeshView mesh = meshes[frame % 2].view();
        EXPECT_TRUE(shows(cuda.wait(), mesh, nullptr, cpu.find_self(mesh))) << "frame " << frame;
    }
}

TEST(CudaDevice, downloads_only_what_wait_has_found) {
    const io::TriangleMesh mesh = cloth(300, 93);
    const DeviceMesh device(mesh.view());
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    const std::vector<std::function<void()>> later_calls{
        [&] { cuda.find_self(mesh.view()); },
        [&] { cuda.has_collision(device.view()); },
        [&] { cuda.launch_self(device.view()); },
        [&] { EXPECT_THROW(cuda.launch_self(mesh.view()), Error); },
        [&] { EXPECT_THROW(cuda.find_self(device.view(), Part{}), Error); },
        [&] { EXPECT_THROW(cuda.partition(mesh.view(), 0), Error); },
    };
    EXPECT_THROW(cuda.download(), Error);
    for (const auto& call : later_calls) {
        cuda.launch_self(device.view());
        cuda.wait();
        EXPECT_TRUE(same_answer(cuda.download(), cpu.find_self(mesh.view())));
        EXPECT_TRUE(same_answer(cuda.download(), cpu.find_self(mesh.view())));
        call();
        EXPECT_THROW(cuda.download(), Error);
    }
}

TEST(CudaDevice, is_not_blamed_for_errors_of_others) {
    const io::TriangleMesh mesh = cloth(300);
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    ASSERT_NE(cudaSetDevice(1000), cudaSuccess);  // and nobody asks for the last error
    EXPECT_TRUE(same_answer(cuda.find_self(mesh.view()), cpu.find_self(mesh.view())));
}

TEST(CudaDevice, launches_between_two_meshes) {
    const io::TriangleMesh mesh = cloth(700);
    const auto [a, b] = halves(mesh.view());
    const DeviceMesh device_a(a), device_b(b);
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    for (int repeat = 0; repeat < 3; ++repeat) {
        cuda.launch_between(device_a.view(), device_b.view());
        EXPECT_TRUE(shows(cuda.wait(), a, &b, cpu.find_between(a, b)));
    }
}

TEST(CudaDevice, forgets_a_launch_that_nobody_waited_for) {
    const io::TriangleMesh first = cloth(300), second = cloth(500);
    const DeviceMesh device_first(first.view()), device_second(second.view());
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    cuda.launch_self(device_first.view());
    cuda.launch_self(device_second.view());
    EXPECT_TRUE(shows(cuda.wait(), second.view(), nullptr, cpu.find_self(second.view())));
    cuda.launch_self(device_first.view());
    EXPECT_TRUE(same_answer(cuda.find_self(second.view()), cpu.find_self(second.view())));
    EXPECT_THROW(cuda.wait(), Error);
    cuda.launch_self(device_first.view());
}

TEST(CudaDevice, reports_bad_input_when_waited_for) {
    io::TriangleMesh mesh = cloth(300);
    mesh.triangles[5] = 1'000'000;
    const DeviceMesh bad(mesh.view());
    Detector cuda({.backend = Backend::cuda});
    cuda.launch_self(bad.view());
    EXPECT_THROW(cuda.wait(), Error);
    const io::TriangleMesh good = cloth(300);
    const DeviceMesh device(good.view());
    cuda.launch_self(device.view());
    EXPECT_EQ(cuda.wait().pair_count, static_cast<std::int64_t>(Detector().find_self(good.view()).pairs.size()));
}

TEST(CudaDevice, launches_under_any_memory_limit_or_names_one_that_suffices) {
    const io::TriangleMesh mesh = cloth(600);
    const DeviceMesh device(mesh.view());
    const Query query{.contacts = true};
    Detector cpu({.backend = Backend::cpu});
    const Collisions& expected = cpu.find_self(mesh.view(), query);
    const auto shows_all = [&](Detector& cuda) {
        cuda.launch_self(device.view(), query);
        EXPECT_TRUE(shows(cuda.wait(), mesh.view(), nullptr, expected));
        EXPECT_TRUE(same_answer(cuda.download(), expected));
    };
    Detector unlimited({.backend = Backend::cuda});
    shows_all(unlimited);
    int failures = 0;
    for (std::int64_t limit = unlimited.find_self(device.view(), query).statistics.peak_memory_bytes; limit > 1'000;
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
            Detector enough({.backend = Backend::cuda, .memory_limit = error.bytes_needed});
            EXPECT_NO_THROW(shows_all(enough)) << error.bytes_needed << " bytes do not suffice";
        }
    }
    EXPECT_GT(failures, 2);
}

TEST(CudaDevice, names_the_triangle_that_names_no_vertex_in_every_call) {
    for (const std::int32_t wrong : {-5, 1'000'000, 2'000'000'000}) {
        io::TriangleMesh mesh = cloth(300);
        mesh.triangles[22] = wrong;
        const DeviceMesh bad(mesh.view());
        Detector cuda({.backend = Backend::cuda}), cpu({.backend = Backend::cpu});
        const auto says = [](auto call) -> std::string {
            try {
                call();
            } catch (const Error& error) {
                EXPECT_EQ(error.index, 7);
                return error.what();
            }
            return "nothing";
        };
        const std::string expected = says([&] { cpu.find_self(mesh.view()); });
        EXPECT_EQ(says([&] { cuda.find_self(bad.view()); }), expected);
        EXPECT_EQ(says([&] { cuda.has_collision(bad.view()); }), expected);
        EXPECT_EQ(says([&] { cuda.partition(bad.view(), 4); }), expected);
    }
}

TEST(CudaDevice, puts_long_rows_in_order) {
    // One long triangle through a stack of small ones: more pairs of one first triangle than threads look at.
    std::vector<std::array<float, 3>> vertices{{0, 0, -1}, {0, 0.25f, -1}, {0, 0, 1001}};
    std::vector<std::array<std::int32_t, 3>> triangles{{0, 1, 2}};
    for (int i = 0; i < 1000; ++i) {
        const auto z = static_cast<float>(i), n = static_cast<float>(vertices.size());
        for (const auto& [x, y] : {std::pair{-1.0f, -1.0f}, {1.0f, -1.0f}, {0.0f, 1.0f}}) vertices.push_back({x, y, z});
        const auto first = static_cast<std::int32_t>(n);
        triangles.push_back({first, first + 1, first + 2});
    }
    const MeshView mesh(vertices, triangles);
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    const Collisions& found = cuda.find_self(mesh);
    EXPECT_EQ(found.pairs.size(), 1000u);
    EXPECT_TRUE(same_answer(found, cpu.find_self(mesh)));
}

// How blocks take turns must not show. On a device many repetitions are cheap: CRUMPLE_REPEATS.
TEST(CudaDevice, answers_the_same_bytes_every_time) {
    const char* wanted = std::getenv("CRUMPLE_REPEATS");
    const int repeats = wanted ? std::atoi(wanted) : 3;
    ASSERT_GT(repeats, 0);
    const io::TriangleMesh mesh = cloth(200 * repeats);
    const DeviceMesh device(mesh.view());
    const Query query{.contacts = true};
    Detector cpu({.backend = Backend::cpu}), warm({.backend = Backend::cuda});
    const Collisions& expected = cpu.find_self(mesh.view(), query);
    ASSERT_GT(expected.pairs.size(), 0u);
    for (int i = 0; i < repeats; ++i) {
        Detector cold({.backend = Backend::cuda});
        ASSERT_TRUE(same_answer(warm.find_self(device.view(), query), expected)) << "warm, run " << i;
        ASSERT_TRUE(same_answer(cold.find_self(device.view(), query), expected)) << "new, run " << i;
    }
}

TEST(CudaDevice, tells_meshes_apart_from_those_of_the_host) {
    const io::TriangleMesh mesh = cloth(100);
    const DeviceMesh device(mesh.view());
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    EXPECT_THROW(cpu.find_self(device.view()), Error);
    EXPECT_THROW(cpu.launch_self(device.view()), Error);
    EXPECT_THROW(cuda.launch_self(mesh.view()), Error);
    EXPECT_THROW(cuda.find_between(device.view(), mesh.view()), Error);
    EXPECT_THROW(cuda.find_between(mesh.view(), device.view()), Error);
    EXPECT_THROW(cpu.partition(device.view(), 4), Error);
}

}  // namespace
}  // namespace crumple::test
