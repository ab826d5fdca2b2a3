#pragma once

// Whole bodies that a rank searches: its own, and copies of those of other ranks, each sent once. A shape is sent once
// to each rank that needs it, with the coordinates and the pose that its rank has, so that a search has the same bytes
// as on the rank that provided the body.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/memory_claim.h"
#include "crumple/world.h"
#include "distributed/overlaps/pairs_of_bodies.h"
#include "distributed/rank_bodies.h"
#include "distributed/transport/message_batches.h"

namespace crumple::distribute {

class BodyCopies {
   public:
    /// `meter` counts the copies.
    explicit BodyCopies(MemoryMeter& meter) : memory_(meter) {}

    /// Exchanges the bodies that other ranks search. Collective.
    void exchange(MessageBatches& batches, CollectiveCheck& agree, const Bodies& bodies, const PairsOfBodies& pairs);

    /// Returns the bodies that this rank searches, in the order of their numbers over all ranks. The first shapes are
    /// those of the local world.
    World world() const { return {shapes_, bodies_, poses_}; }
    std::int32_t number_of(std::int32_t body) const { return ids_[static_cast<std::size_t>(body)]; }
    /// Returns the index of a body in world() by its number over all ranks, or −1.
    std::int32_t place_of(std::int32_t number) const;

   private:
    struct BodyRow {
        std::int32_t id, shape;  ///< `shape`: index in the shapes that the same rank sends
        Pose pose;
    };
    struct ShapeRow {
        std::int64_t vertices, triangles, float32;
    };
    using Corners = std::array<std::int32_t, 3>;
    using Floats = std::array<float, 3>;
    using Doubles = std::array<double, 3>;

    void list_leaving(const Bodies& bodies, const PairsOfBodies& pairs, int ranks, int rank);
    void read_local(const Bodies& bodies, const PairsOfBodies& pairs, int rank);
    void add_copies(const PairsOfBodies& pairs);
    template <class Row, class Count, class Read>
    void exchange_rows(MessageBatches& batches, CollectiveCheck& agree, const Bodies& bodies, Count count, Read read,
                       std::vector<Row>& coming);

    MemoryClaim memory_;
    // To be sent to each rank:
    std::vector<std::vector<BodyRow>> leaving_;
    std::vector<std::vector<std::int32_t>> leaving_shapes_;  ///< indices of local shapes
    // Received, in the order of ranks:
    std::vector<BodyRow> coming_;
    std::vector<std::int64_t> coming_first_shape_;  ///< by body of coming_: index of the first shape of its rank
    std::vector<ShapeRow> coming_shapes_;
    std::vector<Floats> floats_;
    std::vector<Doubles> doubles_;
    std::vector<Corners> corners_;

    std::vector<Shape> shapes_;
    std::vector<std::int32_t> ids_;
    std::vector<Body> bodies_;
    std::vector<Pose> poses_;
};

}  // namespace crumple::distribute
