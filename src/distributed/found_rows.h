#pragma once

// Sends intersections from the rank that found them to the rank that provided their first triangle.

#include <array>
#include <cstdint>
#include <vector>

#include "crumple/distributed.h"
#include "distributed/assembled_part.h"
#include "distributed/transport/collective_check.h"
#include "distributed/transport/message_batches.h"

namespace crumple::distribute {

class FoundRows {
   public:
    explicit FoundRows(int ranks) : for_rank_(static_cast<std::size_t>(ranks)) {}

    /// Adds the pairs found in a part; `found` has indices of triangles within the part.
    void add(const AssembledPart& part, const Intersections& found);

    /// Exchanges all rows. `result` receives this rank's rows, sorted. Collective.
    void exchange(MessageBatches& batches, CollectiveCheck& agree, bool contacts, DistributedIntersections& result);

   private:
    struct Points {
        ContactKind kind;
        std::uint8_t count;
    };
    struct Rows {
        std::vector<Pair> pairs;
        std::vector<Points> contacts;  ///< 1 per pair
        std::vector<std::array<double, 3>> points;
    };
    static void order_pairs(Rows& coming, DistributedIntersections& result);
    static void order_contacts(Rows& coming, DistributedIntersections& result);

    std::vector<Rows> for_rank_;
};

}  // namespace crumple::distribute
