// Questions about features of meshes on the device, as the machine that plays it counts them.

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
    void ask(Detector& cuda, const DeviceStep<float>& there) const {
        EXPECT_TRUE(shows(cuda.launch(there.view().moving_to(there.end()), ImpactQuery()).wait(), expected_));
    }

    const MovingSoup<float> soup_ = falling(200, 90);
    const DeviceStep<float> there_{soup_};
    const Impacts expected_ =
        Detector({.backend = Backend::cpu}).find(soup_.view().moving_to(soup_.end_view()), ImpactQuery());
};

TEST_F(CudaMachineFeatures, are_graphs_of_few_nodes) {
    const MeshView view = there_.view();
    const VertexView end = there_.end();
    struct Case {
        const char* name;
        std::function<void(Detector&)> ask;
        std::size_t chain, nodes;
    };
    const auto impacts = [&](Output wants) {
        return
            [&view, &end, wants](Detector& d) { d.launch(view.moving_to(end), ImpactQuery{.output = wants}).wait(); };
    };
    for (const auto& [name, ask, chain, nodes] :
         {Case{"impacts", impacts(Output::pairs), 20, 26},
          {"first", impacts(Output::first), 16, 22},
          {"any", impacts(Output::any), 14, 20},
          {"near", [&](Detector& d) { d.launch(view, ProximityQuery{.radius = 0.01}).wait(); }, 17, 23},
          {"candidates", [&](Detector& d) { d.launch(view.moving_to(end), CandidateQuery()).wait(); }, 15, 21}}) {
        SCOPED_TRACE(name);
        Detector cuda({.backend = Backend::cuda, .clusters = 3});
        for (int frame = 0; frame < 5; ++frame) ask(cuda);
        EXPECT_EQ(cuda_on_cpu::graph_count().chain, chain);
        EXPECT_EQ(cuda_on_cpu::graph_count().nodes, nodes);
        // No kernel beside the graph, and no memory.
        settings().launches_before_failure = settings().allocations_before_failure = 0;
        ask(cuda);
        settings().launches_before_failure = settings().allocations_before_failure = -1;
    }
}

// Each frame has other arrays, and one graph does for all.
TEST_F(CudaMachineFeatures, move_without_a_new_graph) {
    std::vector<DeviceStep<float>> copies;
    for (int i = 0; i < 12; ++i) copies.emplace_back(soup_);
    Detector cuda({.backend = Backend::cuda});
    for (int i = 0; i < 4; ++i) ask(cuda, copies[static_cast<std::size_t>(i)]);
    const std::size_t graphs = cuda_on_cpu::graph_count().instantiated;
    for (std::size_t i = 4; i < copies.size(); ++i) ask(cuda, copies[i]);
    EXPECT_EQ(cuda_on_cpu::graph_count().instantiated, graphs);
}

TEST_F(CudaMachineFeatures, may_run_out_of_memory_at_any_allocation_or_launch) {
    for (int before = 0; before < 40; before += before < 20 ? 1 : 4) {
        SCOPED_TRACE(before);
        Detector first({.backend = Backend::cuda}), second({.backend = Backend::cuda});
        const auto answers_or_says_so = [&](Detector& cuda, int& failure) {
            failure = before;
            try {
                EXPECT_TRUE(same_features(cuda.find(there_.view().moving_to(there_.end()), ImpactQuery()), expected_));
                const auto older = cuda.launch(there_.view().moving_to(there_.end()), ImpactQuery()),
                           newer = cuda.launch(there_.view().moving_to(there_.end()), ImpactQuery());
                EXPECT_TRUE(shows(older.wait(), expected_));
                EXPECT_TRUE(shows(newer.wait(), expected_));
            } catch (const Error& error) {
                EXPECT_EQ(error.code, ErrorCode::device) << error.what();
            }
            failure = -1;
            ask(cuda, there_);
        };
        answers_or_says_so(first, settings().allocations_before_failure);
        answers_or_says_so(second, settings().launches_before_failure);
        if (HasFailure()) return;
    }
}

TEST_F(CudaMachineFeatures, say_what_limit_a_launch_needs) {
    std::int64_t limit = 1 << 25;
    int answers = 0;
    for (;; limit = limit * 2 / 3, ++answers) {
        Detector cuda({.backend = Backend::cuda, .memory_limit = limit});
        try {
            ask(cuda, there_);
        } catch (const Error& error) {
            ASSERT_EQ(error.code, ErrorCode::memory_limit);
            EXPECT_GT(error.bytes_needed, limit);
            sufficient_limit({.backend = Backend::cuda, .memory_limit = limit},
                             [&](Detector& enough) { ask(enough, there_); });
            break;
        }
    }
    EXPECT_GE(answers, 1);
}

}  // namespace
}  // namespace crumple::test
