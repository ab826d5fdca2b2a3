// Tests of meshes and results in device memory. Calls only the CUDA runtime, so that it runs on a device or on one that
// the CPU emulates.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "agreement/compare.h"
#include "agreement/hard_soups.h"
#include "crumple/error.h"
#include "cuda/cloth.h"
#include "cuda/device_mesh.h"
#include "halves.h"

namespace crumple::test {
namespace {

TEST(CudaDevice, hard_soups_in_device_memory_match_the_cpu) {
    for (const NamedMesh& scene : hard_soups()) {
        SCOPED_TRACE(scene.name);
        const MeshView host = scene.mesh.view();
        const DeviceMesh device(host);
        Detector reference({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
        for (const bool weld : {false, true}) {
            const IntersectionQuery query{.output = !weld ? Output::contacts : Output::pairs, .weld = weld};
            EXPECT_TRUE(same_result(cuda.find(device.view(), query), reference.find(host, query)));
        }
        EXPECT_EQ(cuda.any(device.view()), reference.any(host));
    }
}

TEST(CudaDevice, int64_indices_and_strided_triangles_are_read) {
    const io::TriangleMesh mesh = cloth(600);
    MeshView host = mesh.view();
    host.groups = {};
    std::vector<std::int64_t> wide(static_cast<std::size_t>(3 * host.triangles.rows));
    for (std::size_t i = 0; i < wide.size(); ++i) wide[i] = static_cast<const std::int32_t*>(host.triangles.data)[i];
    MeshView with_wide = host;
    with_wide.triangles = rows_of_three(wide.data(), host.triangles.rows);
    const DeviceMesh device(with_wide);
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    EXPECT_TRUE(same_result(cuda.find(device.view()), cpu.find(host)));

    MeshView every_other = device.view(), host_every_other = host;
    for (MeshView* view : {&every_other, &host_every_other}) {
        view->triangles.rows /= 2;
        view->triangles.row_stride *= 2;
    }
    EXPECT_TRUE(same_result(cuda.find(every_other), cpu.find(host_every_other)));
}

TEST(CudaDevice, unaligned_arrays_are_read) {
    const io::TriangleMesh mesh = cloth(600, 93);
    for (const bool in_double : {false, true}) {
        std::vector<std::byte> vertices(1), triangles(1);  // one byte, so that the first row is unaligned
        const auto append = [](std::vector<std::byte>& bytes, auto value) {
            const auto* begin = reinterpret_cast<const std::byte*>(&value);
            bytes.insert(bytes.end(), begin, begin + sizeof value);
        };
        for (const float x : std::get<std::vector<float>>(mesh.vertices))
            in_double ? append(vertices, static_cast<double>(x)) : append(vertices, x);
        for (const std::int32_t i : mesh.triangles)
            in_double ? append(triangles, static_cast<std::int64_t>(i)) : append(triangles, i);
        const DeviceBytes device_vertices(vertices), device_triangles(triangles);
        MeshView view;
        const std::int64_t scalar = in_double ? 8 : 4;
        view.vertices = {static_cast<const std::byte*>(device_vertices.data()) + 1, mesh.view().vertices.rows,
                         3 * scalar, scalar, in_double ? ScalarType::float64 : ScalarType::float32};
        view.triangles = {static_cast<const std::byte*>(device_triangles.data()) + 1, mesh.view().triangles.rows,
                          3 * scalar, scalar, in_double ? IndexType::int64 : IndexType::int32};
        view.memory = MemorySpace::cuda;
        Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
        EXPECT_TRUE(same_result(cuda.find(view, {.output = Output::contacts}),
                                cpu.find(mesh.view(), {.output = Output::contacts})));
    }
}

TEST(CudaDevice, two_meshes_with_groups_and_parts_match_the_cpu) {
    const io::TriangleMesh mesh = cloth(800);
    const Halves half(mesh.view());
    const MeshView &a = half.a, &b = half.b;
    std::vector<std::int32_t> groups(static_cast<std::size_t>(a.triangles.rows));
    for (std::size_t i = 0; i < groups.size(); ++i) groups[i] = static_cast<std::int32_t>(i % 3);
    MeshView grouped = a;
    grouped.groups = groups;
    const DeviceMesh device_a(grouped), device_b(b);
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    for (const PairScope scope : {PairScope::both, PairScope::between, PairScope::within}) {
        const IntersectionQuery query{.weld = true, .filter = {.groups = scope}};
        EXPECT_TRUE(same_result(cuda.find({device_a.view(), device_b.view()}, query), cpu.find({grouped, b}, query)));
    }
    const IntersectionQuery contacts{.output = Output::contacts, .filter = {.groups = PairScope::between}};
    for (const int count : {3, 70})
        for (const Part& part : cpu.partition({grouped, b}, {}, count))
            EXPECT_TRUE(same_result(cuda.find(part, contacts), cpu.find(part, contacts)));
}

TEST(CudaDevice, one_mesh_can_have_64_clusters_and_two_meshes_63) {
    const io::TriangleMesh mesh = cloth(800);
    const MeshView host = mesh.view();
    const Halves half(host);
    const DeviceMesh whole(host), a(half.a), b(half.b);
    Detector cpu({.backend = Backend::cpu});
    for (const int leaf_size : {3000, 3}) {  // one level of clusters, and two
        Detector cuda({.backend = Backend::cuda, .clusters = 64, .leaf_size = leaf_size});
        for (int turn = 0; turn < 2; ++turn) {
            const Intersections& self = cuda.find(whole.view());
            EXPECT_EQ(self.statistics.clusters, 64);
            EXPECT_TRUE(same_result(self, cpu.find(host)));
            const Intersections& between = cuda.find({a.view(), b.view()});
            EXPECT_EQ(between.statistics.clusters, 63);
            EXPECT_TRUE(same_result(between, cpu.find({half.a, half.b})));
        }
    }
}

TEST(CudaDevice, parts_equal_those_of_the_cpu) {
    const io::TriangleMesh mesh = cloth(1501);
    const Halves half(mesh.view());
    const DeviceMesh device(mesh.view()), device_a(half.a), device_b(half.b);
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    const auto same = [](const PartMesh& a, const PartMesh& b) {
        return a.vertices == b.vertices && a.corners == b.corners && a.ids == b.ids && a.groups == b.groups;
    };
    const auto expect_same = [&](const std::vector<Part>& found, const std::vector<Part>& expected) {
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t k = 0; k < found.size(); ++k) {
            EXPECT_EQ(found[k].index, expected[k].index);
            EXPECT_EQ(found[k].count, expected[k].count);
            EXPECT_TRUE(same(found[k].mesh, expected[k].mesh));
            EXPECT_EQ(found[k].second.has_value(), expected[k].second.has_value());
            if (expected[k].second) {
                EXPECT_TRUE(same(*found[k].second, *expected[k].second));
            }
            ASSERT_EQ(found[k].levels.size(), expected[k].levels.size());
            for (std::size_t l = 0; l < expected[k].levels.size(); ++l) {
                EXPECT_EQ(found[k].levels[l].cluster, expected[k].levels[l].cluster);
                EXPECT_EQ(found[k].levels[l].masks, expected[k].levels[l].masks);
            }
        }
    };
    for (const int count : {1, 3, 64, 100}) {
        expect_same(cuda.partition(device.view(), {}, count), cpu.partition(mesh.view(), {}, count));
        expect_same(cuda.partition({device_a.view(), device_b.view()}, {}, count),
                    cpu.partition({half.a, half.b}, {}, count));
    }
    expect_same(cuda.partition(DeviceMesh(MeshView()).view(), {}, 2), cpu.partition(MeshView(), {}, 2));
    std::vector<Pair> joined;
    for (const Part& part : cuda.partition(device.view(), {}, 5))
        for (const Pair& pair : cuda.find(part).pairs) joined.push_back(pair);
    std::sort(joined.begin(), joined.end());
    const Intersections& whole = cpu.find(mesh.view());
    EXPECT_TRUE(std::equal(joined.begin(), joined.end(), whole.pairs.begin(), whole.pairs.end()));
}

TEST(CudaDevice, errors_name_the_invalid_element) {
    io::TriangleMesh mesh = cloth(300);
    const auto message = [&](const MeshView& view) -> std::string {
        const DeviceMesh device(view);
        Detector cuda({.backend = Backend::cuda});
        try {
            cuda.find(device.view());
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

    // A diverged simulation: no NaN equals another one, which must not make welding slow.
    const std::vector<std::array<float, 3>> all_nan(100'000, {NAN, 0, 0});
    const std::vector<std::array<std::int32_t, 3>> one{{0, 1, 2}};
    const DeviceMesh blown_up(MeshView(all_nan, one));
    try {
        Detector({.backend = Backend::cuda}).find(blown_up.view(), {.weld = true});
        ADD_FAILURE() << "no error";
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(), "vertex 0 is not finite");
    }
}

TEST(CudaDevice, find_matches_the_cpu_after_an_earlier_cuda_error) {
    const io::TriangleMesh mesh = cloth(300);
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    ASSERT_NE(cudaSetDevice(1000), cudaSuccess);  // CUDA keeps this as the last error
    EXPECT_TRUE(same_result(cuda.find(mesh.view()), cpu.find(mesh.view())));
}

TEST(CudaDevice, find_any_and_partition_report_an_invalid_vertex_index) {
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
        const std::string expected = says([&] { cpu.find(mesh.view()); });
        EXPECT_EQ(says([&] { cuda.find(bad.view()); }), expected);
        EXPECT_EQ(says([&] { cuda.any(bad.view()); }), expected);
        EXPECT_EQ(says([&] { cuda.partition(bad.view(), {}, 4); }), expected);
    }
}

TEST(CudaDevice, thousand_pairs_of_one_triangle_are_sorted) {
    // One long triangle through a stack of small ones: more pairs with one first triangle than threads that sort them.
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
    const Intersections& found = cuda.find(mesh);
    EXPECT_EQ(found.pairs.size(), 1000u);
    EXPECT_TRUE(same_result(found, cpu.find(mesh)));
}

// Results must not depend on the order in which blocks run. CRUMPLE_REPEATS sets the number of repetitions, which can
// be large on a device.
TEST(CudaDevice, repeated_calls_give_the_same_bytes) {
    const char* repeats_text = std::getenv("CRUMPLE_REPEATS");
    const int repeats = repeats_text ? std::atoi(repeats_text) : 3;
    ASSERT_GT(repeats, 0);
    const io::TriangleMesh mesh = cloth(200 * repeats);
    const DeviceMesh device(mesh.view());
    const IntersectionQuery query{.output = Output::contacts};
    Detector cpu({.backend = Backend::cpu}), warm({.backend = Backend::cuda});
    const Intersections& expected = cpu.find(mesh.view(), query);
    ASSERT_GT(expected.pairs.size(), 0u);
    for (int i = 0; i < repeats; ++i) {
        Detector cold({.backend = Backend::cuda});
        ASSERT_TRUE(same_result(warm.find(device.view(), query), expected)) << "warm, run " << i;
        ASSERT_TRUE(same_result(cold.find(device.view(), query), expected)) << "new, run " << i;
    }
}

TEST(CudaDevice, meshes_in_the_wrong_memory_are_rejected) {
    const io::TriangleMesh mesh = cloth(100);
    const DeviceMesh device(mesh.view());
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    EXPECT_THROW(cpu.find(device.view()), Error);
    EXPECT_THROW(cpu.launch(device.view()), Error);
    EXPECT_THROW(cuda.launch(mesh.view()), Error);
    EXPECT_THROW(cuda.find({device.view(), mesh.view()}), Error);
    EXPECT_THROW(cuda.find({mesh.view(), device.view()}), Error);
    EXPECT_THROW(cpu.partition(device.view(), {}, 4), Error);
}

}  // namespace
}  // namespace crumple::test
