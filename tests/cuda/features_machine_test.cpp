// Tests of feature queries about meshes on an emulated device, which counts graphs, launches and allocations.

#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "crumple/error.h"
#include "cuda/device_step.h"
#include "cuda/falling.h"
#include "cuda_on_cpu/machine/graph.h"
#include "cuda_on_cpu/machine/settings.h"
#include "error_of.h"
#include "memory_limit.h"

namespace crumple::test {
namespace {

using cuda_on_cpu::settings;

class CudaMachineFeatures : public testing::Test {
   protected:
    void TearDown() override {
        settings() = {};
        settings().multiprocessors = 1;
    }
    void run(Detector& cuda, const DeviceStep<float>& on_device) const {
        EXPECT_TRUE(shows(cuda.launch(on_device.view().moving_to(on_device.end()), ImpactQuery()).wait(), expected_));
    }

    const MovingSoup<float> soup_ = falling(200, 90);
    const DeviceStep<float> on_device_{soup_};
    const Impacts expected_ =
        Detector({.backend = Backend::cpu}).find(soup_.view().moving_to(soup_.end_view()), ImpactQuery());
};

TEST_F(CudaMachineFeatures, launches_are_graphs_of_at_most_26_nodes) {
    const MeshView view = on_device_.view();
    const VertexView end = on_device_.end();
    struct Case {
        const char* name;
        std::function<void(Detector&)> run;
        std::size_t chain, nodes;
    };
    const auto impacts = [&](Output output) {
        return
            [&view, &end, output](Detector& d) { d.launch(view.moving_to(end), ImpactQuery{.output = output}).wait(); };
    };
    for (const auto& [name, run, chain, nodes] :
         {Case{"impacts", impacts(Output::pairs), 20, 26},
          {"first", impacts(Output::first), 16, 22},
          {"any", impacts(Output::any), 14, 20},
          {"near", [&](Detector& d) { d.launch(view, ProximityQuery{.radius = 0.01}).wait(); }, 17, 23},
          {"candidates", [&](Detector& d) { d.launch(view.moving_to(end), CandidateQuery()).wait(); }, 15, 21}}) {
        SCOPED_TRACE(name);
        Detector cuda({.backend = Backend::cuda, .clusters = 3});
        for (int frame = 0; frame < 5; ++frame) run(cuda);
        EXPECT_EQ(cuda_on_cpu::graph_count().chain, chain);
        EXPECT_EQ(cuda_on_cpu::graph_count().nodes, nodes);
        // A launch needs neither kernels outside of the graph nor new memory.
        settings().launches_before_failure = settings().allocations_before_failure = 0;
        run(cuda);
        settings().launches_before_failure = settings().allocations_before_failure = -1;
    }
}

// The arrays of each frame are at another address; one graph serves all frames.
TEST_F(CudaMachineFeatures, arrays_at_new_addresses_need_no_new_graph) {
    std::vector<DeviceStep<float>> copies;
    for (int i = 0; i < 12; ++i) copies.emplace_back(soup_);
    Detector cuda({.backend = Backend::cuda});
    for (int i = 0; i < 4; ++i) run(cuda, copies[static_cast<std::size_t>(i)]);
    const std::size_t graphs = cuda_on_cpu::graph_count().instantiated;
    for (std::size_t i = 4; i < copies.size(); ++i) run(cuda, copies[i]);
    EXPECT_EQ(cuda_on_cpu::graph_count().instantiated, graphs);
}

TEST_F(CudaMachineFeatures, failed_allocation_or_launch_gives_result_or_device_error) {
    for (int before = 0; before < 40; before += before < 20 ? 1 : 4) {
        SCOPED_TRACE(before);
        Detector first({.backend = Backend::cuda}), second({.backend = Backend::cuda});
        const auto gives_result_or_device_error = [&](Detector& cuda, int& failure) {
            failure = before;
            try {
                EXPECT_TRUE(
                    same_features(cuda.find(on_device_.view().moving_to(on_device_.end()), ImpactQuery()), expected_));
                const auto older = cuda.launch(on_device_.view().moving_to(on_device_.end()), ImpactQuery()),
                           newer = cuda.launch(on_device_.view().moving_to(on_device_.end()), ImpactQuery());
                EXPECT_TRUE(shows(older.wait(), expected_));
                EXPECT_TRUE(shows(newer.wait(), expected_));
            } catch (const Error& error) {
                EXPECT_EQ(error.code, ErrorCode::device) << error.what();
            }
            failure = -1;
            run(cuda, on_device_);
        };
        gives_result_or_device_error(first, settings().allocations_before_failure);
        gives_result_or_device_error(second, settings().launches_before_failure);
        if (HasFailure()) return;
    }
}

TEST_F(CudaMachineFeatures, memory_limit_errors_of_launches_lead_to_a_sufficient_limit) {
    std::int64_t limit = 1 << 25;
    int results = 0;
    for (;; limit = limit * 2 / 3, ++results) {
        Detector cuda({.backend = Backend::cuda, .memory_limit = limit});
        try {
            run(cuda, on_device_);
        } catch (const Error& error) {
            ASSERT_EQ(error.code, ErrorCode::memory_limit);
            EXPECT_GT(error.bytes_needed, limit);
            sufficient_limit({.backend = Backend::cuda, .memory_limit = limit},
                             [&](Detector& enough) { run(enough, on_device_); });
            break;
        }
    }
    EXPECT_GE(results, 1);
}

}  // namespace
}  // namespace crumple::test
