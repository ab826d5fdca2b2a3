#pragma once

// Backend for several devices of one process (Options::devices). Each device is a rank: a thread with a cuda backend of
// its own and a block of the scene's triangles. Queries that ranks do not support are left to the first device, and
// so are all queries under a memory limit.

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "backends/forwarding_backend.h"
#include "distributed/block_of_triangles.h"
#include "distributed/rank_detector.h"
#include "distributed/transport/in_process.h"

namespace crumple::distribute {

class Devices final : public ForwardingBackend {
   public:
    /// Throws Error (backend_unavailable) if one of the devices is not available.
    Devices(const Options& options, MemoryMeter& meter, Cancellation& cancellation);

    void find(const PreparedScene& scene, const IntersectionQuery& query, const Part* part,
              Intersections& result) override;
    bool any(const PreparedScene& scene, const IntersectionQuery& query) override;
    void find(const PreparedScene& scene, const FeatureRequest& query, FeatureResult& result) override;
    void release() override;

    // Meshes and worlds in device memory are left to the first device.
    using ForwardingBackend::any, ForwardingBackend::find;

   private:
    struct Rank {
        Rank(std::shared_ptr<Hub> hub, int rank, const Options& options);
        void set_poll(Cancellation& cancellation);

        InProcess transport;
        RankDetector detector;
        TriangleBlock block;
    };

    bool is_for_all(const PreparedScene& scene) const;
    bool is_for_all(const PreparedScene& scene, const FeatureRequest& query) const;
    void make_ranks();
    /// Runs work(rank) for each rank on a thread of its own, for rank 0 on the caller's. Rethrows the error that caused
    /// a failure; then all ranks are made anew by the next call.
    void on_each(const std::function<void(Rank&)>& work);
    template <class Find>
    const auto& find_on_devices(const PreparedScene& scene, FeatureResult& result, bool listed, Find find);

    Options options_;
    Cancellation& cancellation_;
    std::shared_ptr<Hub> hub_;
    std::vector<std::unique_ptr<Rank>> ranks_;  ///< empty: not made yet
};

}  // namespace crumple::distribute
