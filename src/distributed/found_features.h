#pragma once

// Sends impacts and proximities from the rank that found them to the rank that provided the triangle that owns their
// first feature.

#include <array>
#include <cstdint>
#include <vector>

#include "crumple/distributed.h"
#include "distributed/feature_assembly.h"
#include "distributed/transport/collective_check.h"
#include "distributed/transport/message_batches.h"

namespace crumple::distribute {

class FoundFeatures {
   public:
    explicit FoundFeatures(int ranks) : for_rank_(static_cast<std::size_t>(ranks)) {}

    /// Adds the rows found in a part.
    void add(const FeatureAssembly& part, const Impacts& found);
    void add(const FeatureAssembly& part, const Proximities& found);

    /// Exchanges all rows. `result` receives this rank's rows, sorted. Collective.
    void exchange(MessageBatches& batches, CollectiveCheck& agree, DistributedImpacts& result);
    void exchange(MessageBatches& batches, CollectiveCheck& agree, DistributedProximities& result);

   private:
    // Vertex-face and edge-edge pairs. On ranks every vertex and edge belongs to a triangle, so the other two kinds do
    // not occur.
    static constexpr std::size_t kinds = 2;
    struct Row {
        Pair pair;
        std::array<Edge, 2> ends;  ///< for edges: ids of their vertices
        double value;              ///< toi, or squared distance
        std::array<double, 2> at;  ///< parameters of the closest points
        std::uint8_t flag, type;
    };
    using Rows = std::array<std::vector<Row>, kinds>;

    template <class Result, class Fill>
    void add_rows(const FeatureAssembly& part, const Result& found, Fill fill);
    template <class Result, class Write>
    void exchange_rows(MessageBatches& batches, CollectiveCheck& agree, Result& result, Write write);

    std::vector<Rows> for_rank_;
};

}  // namespace crumple::distribute
