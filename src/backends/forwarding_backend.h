#pragma once

// Decorator: forwards every call to another backend. Subclasses override what they change.

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "backends/backend.h"

namespace crumple {

class ForwardingBackend : public BackendBase {
   public:
    explicit ForwardingBackend(std::unique_ptr<BackendBase> to) : to_(std::move(to)) {}

    void parallel_for(std::size_t n, Task task) override { to_->parallel_for(n, task); }
    void find(const PreparedScene& scene, const IntersectionQuery& query, const Part* part,
              Intersections& result) override {
        to_->find(scene, query, part, result);
    }
    void find_possible(const PreparedScene& scene, Intersections& result) override {
        to_->find_possible(scene, result);
    }
    bool any(const PreparedScene& scene, const IntersectionQuery& query) override { return to_->any(scene, query); }
    int worlds_at_once() const override { return to_->worlds_at_once(); }
    void any_by_world(const PreparedScene& scene, const IntersectionQuery& query, std::span<std::uint8_t> flags,
                      Statistics& statistics) override {
        to_->any_by_world(scene, query, flags, statistics);
    }
    void stream(const PreparedScene& scene, const IntersectionQuery& query, PairStream& to,
                Statistics& statistics) override {
        to_->stream(scene, query, to, statistics);
    }
    void visit(const PreparedScene& scene, const IntersectionQuery& query,
               FunctionRef<void(const Array<Pair>& some)> take, Statistics& statistics) override {
        to_->visit(scene, query, take, statistics);
    }
    void find(const PreparedScene& scene, const FeatureRequest& request, FeatureResult& result) override {
        to_->find(scene, request, result);
    }
    void stream(const PreparedScene& scene, const FeatureRequest& request, FeatureStream& to,
                Statistics& statistics) override {
        to_->stream(scene, request, to, statistics);
    }
    void find(const MeshView& a, const MeshView* b, const IntersectionQuery& query, Intersections& result) override {
        to_->find(a, b, query, result);
    }
    bool any(const MeshView& a, const MeshView* b, const IntersectionQuery& query) override {
        return to_->any(a, b, query);
    }
    std::vector<Part> partition(const MeshView& a, const MeshView* b, int count) override {
        return to_->partition(a, b, count);
    }
    LaunchNumber launch(const MeshView& a, const MeshView* b, const IntersectionQuery& query) override {
        return to_->launch(a, b, query);
    }
    const DeviceIntersections& wait(LaunchNumber launch) override { return to_->wait(launch); }
    void download(LaunchNumber launch, Intersections& result) override { to_->download(launch, result); }
    DeviceFeatureCalls& device_feature_calls() override { return to_->device_feature_calls(); }
    bool find(const World& world, const IntersectionQuery& query, Intersections& result) override {
        return to_->find(world, query, result);
    }
    std::vector<Pose> poses_of(const DevicePoses& poses) override { return to_->poses_of(poses); }
    LaunchNumber launch(const World& world, const IntersectionQuery& query) override {
        return to_->launch(world, query);
    }
    bool keeps_after(const Error& error) const override { return to_->keeps_after(error); }
    const OverlapKernels* overlap_kernels() const override { return to_->overlap_kernels(); }
    OverlapDevice* overlap_device() override { return to_->overlap_device(); }
    Clustering cluster(const PreparedScene& scene) override { return to_->cluster(scene); }
    bool may_have_lost_pairs() override { return to_->may_have_lost_pairs(); }
    void swap_memory(std::unique_ptr<SceneMemory>& memory) override { to_->swap_memory(memory); }
    void release() override { to_->release(); }

   private:
    std::unique_ptr<BackendBase> to_;
};

}  // namespace crumple
