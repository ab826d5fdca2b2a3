// Tests of feature queries while a launch is in flight, after wait(), or captured in a caller's graph: results match
// those of the cpu backend, and launches work afterwards. Calls only the CUDA runtime, so that it runs on a device or
// on one that the CPU emulates.

#include <gtest/gtest.h>

#include <vector>

#include "candidates/compare_candidates.h"
#include "crumple/error.h"
#include "cuda/cloth.h"
#include "cuda/device_mesh.h"
#include "cuda/downloaded_results.h"
#include "error_of.h"
#include "features/compare_features.h"

namespace crumple::test {
namespace {

class CudaBetweenLaunches : public testing::Test {
   protected:
    const io::TriangleMesh start_ = cloth(600, 92), end_ = cloth(600, 93);
    Detector cpu_{Options{.backend = Backend::cpu}}, cuda_{Options{.backend = Backend::cuda}};
    const DeviceMesh device_{start_.view()};

    /// Makes one feature query, about impacts (kind 0), proximities (1) or candidates (2).
    void expect_features(int kind) {
        const VertexView end = end_.view().vertices;
        const ProximityQuery near{.radius = 0.01};
        if (kind == 0) {
            EXPECT_TRUE(same_features(cuda_.find(start_.view().moving_to(end), ImpactQuery()),
                                      cpu_.find(start_.view().moving_to(end), ImpactQuery())));
        } else if (kind == 1) {
            EXPECT_TRUE(same_features(cuda_.find(start_.view(), near), cpu_.find(start_.view(), near)));
        } else {
            EXPECT_TRUE(same_candidates(cuda_.find(start_.view().moving_to(end), CandidateQuery()),
                                        cpu_.find(start_.view().moving_to(end), CandidateQuery())));
        }
    }
    void expect_result(const LaunchTicket<IntersectionQuery>& launched) {
        EXPECT_TRUE(shows(launched.wait(), device_.view(), nullptr, cpu_.find(start_.view())));
    }
    void expect_nothing(const LaunchTicket<IntersectionQuery>& launched) {
        EXPECT_STREQ(error_of([&] { launched.wait(); }).what(),
                     "wait() is too late: another call of the detector came after this launch");
    }
};

TEST_F(CudaBetweenLaunches, feature_query_makes_wait_of_launches_in_flight_an_error) {
    for (int round = 0; round < 6; ++round) {
        std::vector launched{cuda_.launch(device_.view())};
        if (round % 2) launched.push_back(cuda_.launch(device_.view()));
        expect_features(round % 3);
        for (const auto& each : launched) expect_nothing(each);
    }
    expect_result(cuda_.launch(device_.view()));
}

TEST_F(CudaBetweenLaunches, feature_query_after_wait_matches_the_cpu_and_ends_download) {
    for (int kind = 0; kind < 3; ++kind) {
        const auto launched = cuda_.launch(device_.view());
        expect_result(launched);
        expect_features(kind);
        EXPECT_STREQ(error_of([&] { launched.download(); }).what(),
                     "download() is for launches of meshes, and must come right after their wait()");
    }
}

TEST_F(CudaBetweenLaunches, feature_query_makes_wait_of_a_captured_launch_an_error) {
    cudaStream_t stream = nullptr;
    check(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking));
    MeshView view = device_.view();
    view.stream = stream;
    for (int kind = 0; kind < 3; ++kind) {
        for (int call = 0; call < 2; ++call) cuda_.launch(view).wait();
        check(cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal));
        const auto captured = cuda_.launch(view);
        EXPECT_EQ(error_of([&] { cuda_.find(start_.view(), ProximityQuery()); }).code, ErrorCode::invalid_argument)
            << "the capture has not ended";
        cudaGraph_t graph = nullptr;
        check(cudaStreamEndCapture(stream, &graph));
        check(cudaGraphDestroy(graph));
        expect_features(kind);
        expect_nothing(captured);
    }
    expect_result(cuda_.launch(view));
    check(cudaStreamDestroy(stream));
}

}  // namespace
}  // namespace crumple::test
