// Tests of feature queries about meshes in device memory. Calls only the CUDA runtime, so that it runs on a device or
// on one that the CPU emulates.

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "crumple/error.h"
#include "cuda/device_step.h"
#include "cuda/downloaded_results.h"
#include "cuda/falling.h"
#include "error_of.h"
#include "features/listed_soups.h"
#include "rounds.h"

namespace crumple::test {
namespace {

/// Returns a few moving soups of each kind, some with codimensional edges and points.
template <class Scalar>
std::vector<NamedMove<Scalar>> some_moves() {
    std::vector<NamedMove<Scalar>> all = moving_soups<Scalar>(0.2);
    std::size_t i = 0;
    std::erase_if(all, [&](const auto&) { return i++ % (sanitized ? 21 : 7) != 0; });
    const std::size_t plain = all.size();
    for (std::size_t k = 0; k < plain; k += 2)
        all.push_back({all[k].name + ", with lists", with_lists(all[k].soup, static_cast<unsigned>(k)), all[k].unit});
    return all;
}

template <class Scalar>
class CudaDeviceFeatures : public testing::Test {
   protected:
    Detector cpu_{Options{.backend = Backend::cpu}}, cuda_{Options{.backend = Backend::cuda, .leaf_size = 20}};
};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(CudaDeviceFeatures, Precisions);

TYPED_TEST(CudaDeviceFeatures, find_on_device_meshes_matches_the_cpu) {
    for (const auto& [name, soup, unit] : some_moves<TypeParam>()) {
        SCOPED_TRACE(name);
        const DeviceStep<TypeParam> on_device(soup);
        for (const ImpactQuery& query :
             {ImpactQuery{.index = true}, ImpactQuery{.min_distance = unit > 1e300 ? 0 : unit / 2},
              ImpactQuery{.output = Output::first}, ImpactQuery{.output = Output::any}, ImpactQuery{.weld = true},
              ImpactQuery{.triangle_pairs = true}})
            EXPECT_TRUE(same_features(this->cuda_.find(on_device.view().moving_to(on_device.end()), query),
                                      this->cpu_.find(soup.view().moving_to(soup.end_view()), query)));
        if (unit <= 1e300) {
            for (const ProximityQuery& query :
                 {ProximityQuery{.radius = unit / 2, .index = true}, ProximityQuery{.radius = unit / 2, .rings = 2},
                  ProximityQuery{.radius = unit / 4, .closest = true},
                  ProximityQuery{.radius = unit / 4, .least = true}, ProximityQuery{.radius = unit / 4, .weld = true},
                  ProximityQuery{.output = Output::any}})
                EXPECT_TRUE(
                    same_features(this->cuda_.find(on_device.view(), query), this->cpu_.find(soup.view(), query)));
        }
        for (const bool weld : {false, true}) {
            const CandidateQuery query{.kinds = all_candidate_kinds(), .weld = weld};
            EXPECT_TRUE(same_candidates(this->cuda_.find(on_device.view().moving_to(on_device.end()), query),
                                        this->cpu_.find(soup.view().moving_to(soup.end_view()), query)));
            EXPECT_TRUE(
                same_candidates(this->cuda_.find(on_device.view(), query), this->cpu_.find(soup.view(), query)));
        }
        if (this->HasFailure()) return;
    }
}

TYPED_TEST(CudaDeviceFeatures, launch_results_on_the_device_match_the_cpu) {
    cudaStream_t stream;
    check(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking));
    for (const auto& [name, soup, unit] : some_moves<TypeParam>()) {
        SCOPED_TRACE(name);
        const DeviceStep<TypeParam> on_device(soup);
        const MeshView view = on_device.view(stream);
        for (const Output output : {Output::pairs, Output::first, Output::any}) {
            const ImpactQuery query{.output = output};
            EXPECT_TRUE(shows(this->cuda_.launch(view.moving_to(on_device.end()), query).wait(),
                              this->cpu_.find(soup.view().moving_to(soup.end_view()), query)));
        }
        if (unit <= 1e300) {
            const ProximityQuery query{.radius = unit / 2};
            EXPECT_TRUE(shows(this->cuda_.launch(view, query).wait(), this->cpu_.find(soup.view(), query)));
        }
        const CandidateQuery query{.kinds = all_candidate_kinds()};
        EXPECT_TRUE(shows(this->cuda_.launch(view.moving_to(on_device.end()), query).wait(),
                          this->cpu_.find(soup.view().moving_to(soup.end_view()), query)));
        if (this->HasFailure()) return;
    }
    check(cudaStreamDestroy(stream));
}

TEST(CudaDeviceFeatures, proximities_match_the_cpu_for_radii_and_rest_shape_on_the_device) {
    const MovingSoup<float> soup = falling(400, 80);
    const DeviceStep<float> on_device(soup);
    std::vector<double> radii;
    for (std::size_t v = 0; v < soup.start.size(); ++v) radii.push_back(0.01 * static_cast<double>(v % 5));
    const DeviceArray<double> radii_on_device{std::span<const double>(radii)};
    const DeviceArray<PointOf<float>> rest_on_device{std::span<const PointOf<float>>(soup.end)};
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    ProximityQuery query{.radii = radii, .rest = soup.end_view(), .rest_radius = 0.02}, query_on_device = query;
    query_on_device.radii = radii_on_device.span();
    query_on_device.rest.data = rest_on_device.span().data();
    const Proximities& expected = cpu.find(soup.view(), query);
    ASSERT_GT(expected.count, 0);
    EXPECT_TRUE(same_features(cuda.find(on_device.view(), query_on_device), expected));
    for (int frame = 0; frame < 4; ++frame) {
        EXPECT_TRUE(shows(cuda.launch(on_device.view(), query_on_device).wait(), expected)) << "frame " << frame;
    }
    query.closest = query_on_device.closest = true;
    EXPECT_TRUE(same_features(cuda.find(on_device.view(), query_on_device), cpu.find(soup.view(), query)));
}

// The graph of launches is reused from frame to frame, but must read the arrays that each launch passes.
TEST(CudaDeviceFeatures, each_launch_reads_its_own_radii_and_rest_shape) {
    const MovingSoup<float> soup = falling(400, 80);
    const DeviceStep<float> on_device(soup);
    const std::size_t n = soup.start.size();
    const std::vector<PointOf<float>> flat(n, PointOf<float>{0, 0, 0});  // rest shape in which all vertices coincide
    const DeviceArray<PointOf<float>> rest[2]{DeviceArray<PointOf<float>>(std::span<const PointOf<float>>(soup.end)),
                                              DeviceArray<PointOf<float>>(std::span<const PointOf<float>>(flat))};
    const std::vector<double> thin(n, 0.001), thick(n, 0.05);
    const DeviceArray<double> radii[2]{DeviceArray<double>(std::span<const double>(thin)),
                                       DeviceArray<double>(std::span<const double>(thick))};
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    std::int64_t near = 0;
    for (std::size_t frame = 0; frame < 16; ++frame) {
        const std::size_t r = frame / 4 % 2, t = frame % 2;
        ProximityQuery query{.radii = t ? thick : thin, .rest = soup.end_view(), .rest_radius = 0.02},
            query_on_device = query;
        if (r) query.rest.data = flat.data();
        query_on_device.radii = radii[t].span();
        query_on_device.rest.data = rest[r].span().data();
        const Proximities& expected = cpu.find(soup.view(), query);
        near += expected.count;
        ASSERT_TRUE(shows(cuda.launch(on_device.view(), query_on_device).wait(), expected)) << "frame " << frame;
    }
    EXPECT_GT(near, 0);
}

TEST(CudaDeviceFeatures, free_step_matches_the_cpu) {
    const MovingSoup<float> soup = falling(400, 88);
    const DeviceStep<float> on_device(soup);
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    for (const double min_distance : {0.0, 0.01}) {
        const ImpactQuery query{.min_distance = min_distance};
        const FreeStep expected = cpu.find(soup.view().moving_to(soup.end_view()), FreeStepQuery{query});
        const FreeStep found = cuda.find(on_device.view().moving_to(on_device.end()), FreeStepQuery{query});
        EXPECT_EQ(found.share, expected.share);
        EXPECT_TRUE(std::ranges::equal(found.positions, expected.positions));
    }
}

TEST(CudaDeviceFeatures, strided_and_unaligned_arrays_are_read) {
    const MovingSoup<float> soup = falling(200, 80);
    // Unaligned rows of 13 or 25 bytes, with columns in reverse order, and 64-bit indices.
    const auto spread = [](const auto& rows, std::int64_t stride, std::int64_t size, std::size_t begin) {
        std::vector<std::byte> out(begin + static_cast<std::size_t>(stride) * rows.size());
        for (std::size_t i = 0; i < rows.size(); ++i)
            for (std::size_t k = 0; k < 3; ++k)
                std::memcpy(out.data() + begin + i * static_cast<std::size_t>(stride) +
                                (2 - k) * static_cast<std::size_t>(size),
                            &rows[i][k], static_cast<std::size_t>(size));
        return out;
    };
    std::vector<std::array<std::int64_t, 3>> wide;
    for (const auto& t : soup.triangles) wide.push_back({t[0], t[1], t[2]});
    const DeviceBytes start(spread(soup.start, 13, 4, 1)), end(spread(soup.end, 13, 4, 3)),
        triangles(spread(wide, 25, 8, 1));
    const auto place = [](const DeviceBytes& bytes, std::size_t begin) {
        return static_cast<const std::byte*>(bytes.data()) + begin;
    };
    const auto n = static_cast<std::int64_t>(soup.start.size()), m = static_cast<std::int64_t>(wide.size());
    MeshView view(VertexView{place(start, 1) + 8, n, 13, -4, ScalarType::float32},
                  TriangleView{place(triangles, 1) + 16, m, 25, -8, IndexType::int64});
    view.memory = MemorySpace::cuda;
    const VertexView to{place(end, 3) + 8, n, 13, -4, ScalarType::float32};
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    const Impacts& expected = cpu.find(soup.view().moving_to(soup.end_view()), ImpactQuery());
    EXPECT_TRUE(same_features(cuda.find(view.moving_to(to), ImpactQuery()), expected));
    EXPECT_TRUE(shows(cuda.launch(view.moving_to(to), ImpactQuery()).wait(), expected));
    EXPECT_TRUE(same_features(cuda.find(view.moving_to(to), ImpactQuery{.weld = true}),
                              cpu.find(soup.view().moving_to(soup.end_view()), ImpactQuery{.weld = true})));
}

TEST(CudaDeviceFeatures, group_filters_match_the_cpu) {
    MovingSoup<float> soup = falling(400, 85);
    for (std::size_t t = 0; t < soup.triangles.size(); ++t) soup.groups.push_back(static_cast<std::int32_t>(t % 3));
    const DeviceStep<float> on_device(soup);
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    ProximityQuery query{.radius = 0.05};
    for (const PairScope groups : {PairScope::between, PairScope::within, PairScope::both}) {
        query.filter.groups = groups;
        query.filter.excluded_groups = {{0, 1}};
        const Proximities& expected = cpu.find(soup.view(), query);
        ASSERT_GT(expected.count, 0);
        EXPECT_TRUE(same_features(cuda.find(on_device.view(), query), expected));
        EXPECT_TRUE(shows(cuda.launch(on_device.view(), query).wait(), expected));
    }
}

constexpr const char* not_the_oldest = "an older launch is in flight; call wait() in the order of the launches";

// Two launches of different kinds may be in flight. wait() must be called in the order of the launches.
TEST(CudaDeviceFeatures, alternating_launches_of_four_kinds_match_the_cpu) {
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    const MovingSoup<float> first = falling(300, 85), second = falling(500, 88);
    const DeviceStep<float> a(first), b(second);
    const ProximityQuery near{.radius = 0.03};
    for (int round = 0; round < 3; ++round) {
        const auto impacts = cuda.launch(a.view().moving_to(a.end()), ImpactQuery());
        const auto proximities = cuda.launch(b.view(), near);
        EXPECT_STREQ(error_of([&] { cuda.launch(a.view()); }).what(),
                     "two launches are in flight; call wait() before the next launch");
        EXPECT_STREQ(error_of([&] { proximities.wait(); }).what(), not_the_oldest);
        EXPECT_TRUE(shows(impacts.wait(), cpu.find(first.view().moving_to(first.end_view()), ImpactQuery())));
        const auto intersections = cuda.launch(b.view());
        EXPECT_TRUE(shows(proximities.wait(), cpu.find(second.view(), near)));
        const auto candidates = cuda.launch(b.view().moving_to(b.end()), CandidateQuery());
        EXPECT_STREQ(error_of([&] { candidates.wait(); }).what(), not_the_oldest);
        EXPECT_TRUE(shows(intersections.wait(), b.view(), nullptr, cpu.find(second.view())));
        EXPECT_TRUE(same_result(intersections.download(), cpu.find(second.view())));
        EXPECT_TRUE(shows(candidates.wait(), cpu.find(second.view().moving_to(second.end_view()), CandidateQuery())));
        EXPECT_STREQ(error_of([&] { intersections.download(); }).what(),
                     "download() is for launches of meshes, and must come right after their wait()");
        EXPECT_STREQ(error_of([&] { candidates.wait(); }).what(), "wait() has already been called for this launch");
        EXPECT_STREQ(error_of([&] { impacts.wait(); }).what(),
                     "wait() is too late: another call of the detector came after this launch");
    }
}

TEST(CudaDeviceFeatures, two_launches_in_flight_match_the_cpu) {
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda, .leaf_size = 60});
    std::vector<MovingSoup<float>> frames;
    std::vector<DeviceStep<float>> on_device;
    for (int frame = 80; frame < 94; frame += 2) on_device.emplace_back(frames.emplace_back(falling(600, frame)));
    const auto expect_right = [&](const DeviceImpacts& found, std::size_t i) {
        EXPECT_TRUE(shows(found, cpu.find(frames[i].view().moving_to(frames[i].end_view()), ImpactQuery()))) << i;
    };
    std::vector launched{cuda.launch(on_device[0].view().moving_to(on_device[0].end()), ImpactQuery())};
    std::int64_t impacts = 0;
    for (std::size_t i = 1; i < on_device.size(); ++i) {
        launched.push_back(cuda.launch(on_device[i].view().moving_to(on_device[i].end()), ImpactQuery()));
        const DeviceImpacts& found = launched[i - 1].wait();
        impacts += found.count;
        expect_right(found, i - 1);
        if (i + 1 < on_device.size()) continue;
        expect_right(launched[i].wait(), i);
        expect_right(found, i - 1);  // a result is valid until the second launch after its own
    }
    EXPECT_GT(impacts, 0);
}

TEST(CudaDeviceFeatures, near_pairs_are_right_after_triangles_or_edges_changed) {
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    MovingSoup<float> soup = falling(300, 88), torn = soup;
    std::swap(torn.triangles[7], torn.triangles[100]);
    torn.triangles[50] = torn.triangles[51];
    const DeviceStep<float> whole(soup), on_device(torn);
    const ProximityQuery near{.radius = 0.5};
    const Proximities before = cpu.find(soup.view(), near);
    const Proximities after = cpu.find(torn.view(), near);
    ASSERT_FALSE(same_features(before, after)) << before.count;
    for (int round = 0; round < 2; ++round) {
        EXPECT_TRUE(same_features(cuda.find(whole.view(), near), before));
        EXPECT_TRUE(same_features(cuda.find(on_device.view(), near), after));
        const auto older = cuda.launch(whole.view(), near), newer = cuda.launch(on_device.view(), near);
        EXPECT_TRUE(shows(older.wait(), before));
        EXPECT_TRUE(shows(newer.wait(), after));
        // Another number of triangles, and codimensional edges.
        MovingSoup<float> fewer = soup;
        fewer.triangles.resize(200);
        fewer.edges = edges_of(MovingSoup<>{{}, {}, soup.triangles, {}});
        const DeviceStep<float> few(fewer);
        EXPECT_TRUE(shows(cuda.launch(few.view(), near).wait(), cpu.find(fewer.view(), near)));
        std::swap(fewer.edges->front(), fewer.edges->back());
        const DeviceStep<float> swapped(fewer);
        EXPECT_TRUE(shows(cuda.launch(swapped.view(), near).wait(), cpu.find(fewer.view(), near)));
    }
}

TEST(CudaDeviceFeatures, errors_equal_those_of_the_cpu) {
    constexpr float inf = std::numeric_limits<float>::infinity();
    const MovingSoup<float> good = falling(200, 80);
    std::vector<double> radii(good.start.size(), 0.01);
    struct Case {
        std::string name;
        std::function<void(MovingSoup<float>&, std::vector<double>&)> spoil;
        bool moving = true;
    };
    const std::vector<Case> cases{
        {"start", [&](auto& soup, auto&) { soup.start[9][1] = inf; }},
        {"end", [&](auto& soup, auto&) { soup.end[11][2] = -inf; }},
        {"both", [&](auto& soup, auto&) { soup.end[3][2] = inf, soup.start[70][0] = std::nanf(""); }},
        {"triangle", [&](auto& soup, auto&) { soup.triangles[5][1] = 100000; }},
        {"triangle and end", [&](auto& soup, auto&) { soup.triangles[8][0] = -3, soup.end[3][2] = inf; }},
        {"radius", [&](auto&, auto& r) { r[12] = -1; }, false},
        {"no radius", [&](auto&, auto& r) { r[13] = std::nan(""); }, false},
        {"rest", [&](auto& soup, auto&) { soup.end[20][0] = inf; }, false},
        {"fewer radii", [&](auto&, auto& r) { r.pop_back(); }, false},
        {"fewer ends", [&](auto& soup, auto&) { soup.end.pop_back(); }},
        {"fewer at rest", [&](auto& soup, auto&) { soup.end.pop_back(); }, false},
        {"edge",
         [&](auto& soup, auto&) {
             soup.edges = std::vector<Edge>{{0, 1}, {2, 5000}};
         }},
        {"edge of one",
         [&](auto& soup, auto&) {
             soup.edges = std::vector<Edge>{{2, 2}};
         }},
        {"point", [&](auto& soup, auto&) { soup.points = std::vector<std::int32_t>{-1}; }},
    };
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    const DeviceStep<float> fine(good);
    const Impacts fine_impacts = cpu.find(good.view().moving_to(good.end_view()), ImpactQuery());
    for (const Case& wrong : cases) {
        SCOPED_TRACE(wrong.name);
        const bool moving = wrong.moving;
        MovingSoup<float> soup = good;
        std::vector<double> r = radii;
        wrong.spoil(soup, r);
        const DeviceStep<float> on_device(soup);
        const DeviceArray<double> radii_on_device{std::span<const double>(r)};
        ProximityQuery near{.radii = r, .rest = soup.end_view(), .rest_radius = 0.001}, near_on_device = near;
        near_on_device.radii = radii_on_device.span();
        near_on_device.rest = on_device.end();
        const Error expected = error_of([&] {
            moving ? (void)cpu.find(soup.view().moving_to(soup.end_view()), ImpactQuery())
                   : (void)cpu.find(soup.view(), near);
        });
        const auto same = [&](const Error& error) {
            EXPECT_STREQ(error.what(), expected.what());
            EXPECT_EQ(error.code, expected.code);
            EXPECT_EQ(error.element, expected.element);
            EXPECT_EQ(error.index, expected.index);
        };
        same(error_of([&] {
            moving ? (void)cuda.find(on_device.view().moving_to(on_device.end()), ImpactQuery())
                   : (void)cuda.find(on_device.view(), near_on_device);
        }));
        // A launch with valid input before it still has its result.
        const auto older = cuda.launch(fine.view().moving_to(fine.end()), ImpactQuery());
        bool launched = false;
        const auto wait_for_both = [&](const auto& newer) {
            launched = true;
            EXPECT_TRUE(shows(older.wait(), fine_impacts));
            newer.wait();
        };
        same(error_of([&] {
            moving ? wait_for_both(cuda.launch(on_device.view().moving_to(on_device.end()), ImpactQuery()))
                   : wait_for_both(cuda.launch(on_device.view(), near_on_device));
        }));
        if (!launched) {
            EXPECT_TRUE(shows(older.wait(), fine_impacts));
        }
        EXPECT_TRUE(shows(cuda.launch(fine.view().moving_to(fine.end()), ImpactQuery()).wait(), fine_impacts));
    }
}

TEST(CudaDeviceFeatures, unsupported_launches_are_rejected) {
    const MovingSoup<float> soup = falling(100, 80);
    const DeviceStep<float> on_device(soup);
    Detector cuda({.backend = Backend::cuda}), cpu({.backend = Backend::cpu});
    const auto refused = [](auto call) { return error_of(call).code == ErrorCode::invalid_argument; };
    EXPECT_TRUE(refused([&] { cuda.launch(on_device.view().moving_to(on_device.end()), ImpactQuery{.weld = true}); }));
    EXPECT_TRUE(refused(
        [&] { cuda.launch(on_device.view().moving_to(on_device.end()), ImpactQuery{.triangle_pairs = true}); }));
    EXPECT_TRUE(refused([&] { cuda.launch(on_device.view(), ProximityQuery{.closest = true}); }));
    EXPECT_TRUE(refused([&] { cuda.launch(on_device.view(), ProximityQuery{.least = true}); }));
    EXPECT_TRUE(refused([&] { cuda.launch(on_device.view(), ProximityQuery{.radius = -1}); }));
    EXPECT_TRUE(refused([&] { cuda.launch(on_device.view(), CandidateQuery{.weld = true}); }));
    EXPECT_TRUE(refused([&] { cuda.launch(soup.view().moving_to(soup.end_view()), ImpactQuery()); }));
    EXPECT_TRUE(refused([&] { cuda.launch(on_device.view().moving_to(soup.end_view()), ImpactQuery()); }))
        << "the end on the host";
    EXPECT_TRUE(refused([&] { cpu.launch(on_device.view().moving_to(on_device.end()), ImpactQuery()); }));
    EXPECT_TRUE(refused([&] { cpu.find(on_device.view().moving_to(on_device.end()), ImpactQuery()); }));
    MeshView wrong = on_device.view();
    wrong.vertices.rows = -5;
    for (const bool copied : {false, true}) {
        EXPECT_TRUE(refused([&] { cuda.find(wrong, ProximityQuery{.weld = copied}); }));
        EXPECT_TRUE(refused([&] { cuda.find(wrong.moving_to(on_device.end()), ImpactQuery{.weld = copied}); }));
    }
    EXPECT_TRUE(refused([&] { cuda.find(wrong.moving_to(on_device.end()), FreeStepQuery()); }));
}

// Results that do not fit are computed in chunks, collected on the host and uploaded again.
TEST(CudaDeviceFeatures, results_under_a_memory_limit_match_the_cpu) {
    const MovingSoup<float> soup = falling(1500, 90);
    const DeviceStep<float> on_device(soup);
    Detector cpu({.backend = Backend::cpu});
    const ImpactQuery query{.min_distance = 0.02};
    const Impacts& impacts = cpu.find(soup.view().moving_to(soup.end_view()), query);
    const Candidates& candidates = cpu.find(soup.view().moving_to(soup.end_view()), CandidateQuery());
    ASSERT_GT(impacts.count, 100);
    for (const std::int64_t limit : {40'000'000, 17'000'000}) {
        Detector cuda({.backend = Backend::cuda, .memory_limit = limit});
        for (int call = 0; call < 2; ++call) {
            const auto older = cuda.launch(on_device.view().moving_to(on_device.end()), query),
                       newer = cuda.launch(on_device.view().moving_to(on_device.end()), query);
            EXPECT_TRUE(shows(older.wait(), impacts)) << limit;
            EXPECT_TRUE(shows(newer.wait(), impacts)) << limit;
            EXPECT_TRUE(same_features(cuda.find(on_device.view().moving_to(on_device.end()), query), impacts));
        }
        EXPECT_TRUE(
            shows(cuda.launch(on_device.view().moving_to(on_device.end()), CandidateQuery()).wait(), candidates))
            << limit;
    }
    Detector cuda({.backend = Backend::cuda, .memory_limit = 100'000});
    const Error error = error_of([&] { cuda.launch(on_device.view().moving_to(on_device.end()), query).wait(); });
    EXPECT_EQ(error.code, ErrorCode::memory_limit);
    EXPECT_GT(error.bytes_needed, 100'000);
}

TEST(CudaDeviceFeatures, detectors_on_several_threads_match_the_cpu) {
    std::vector<std::thread> threads;
    for (int i = 0; i < 3; ++i)
        threads.emplace_back([i] {
            const MovingSoup<float> soup = falling(200 + 100 * i, 85);
            const DeviceStep<float> on_device(soup);
            Detector cpu({.backend = Backend::cpu, .threads = 1}), cuda({.backend = Backend::cuda});
            const Impacts& expected = cpu.find(soup.view().moving_to(soup.end_view()), ImpactQuery());
            for (int frame = 0; frame < 3; ++frame) {
                EXPECT_TRUE(
                    shows(cuda.launch(on_device.view().moving_to(on_device.end()), ImpactQuery()).wait(), expected));
            }
        });
    for (std::thread& thread : threads) thread.join();
}

}  // namespace
}  // namespace crumple::test
