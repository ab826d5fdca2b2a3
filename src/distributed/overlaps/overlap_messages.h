#pragma once

// Rows of overlap queries as messages between ranks.

#include <cstddef>
#include <span>
#include <vector>

#include "crumple/export.h"
#include "crumple/overlaps.h"
#include "distributed/transport/collective_check.h"
#include "distributed/transport/message_batches.h"

namespace crumple::distribute {

class OverlapMessages {
   public:
    /// `meter` counts the rows to be sent, and messages.
    OverlapMessages(int ranks, MemoryMeter& meter);

    /// Lists of rows to be sent to a rank.
    Overlaps& for_rank(int rank) { return for_rank_[static_cast<std::size_t>(rank)]; }
    /// Sends all rows. `result` gets those that this rank receives, by ascending pairs of bodies, each of which must
    /// occur once; its lists by world and body stay unchanged. Collective.
    void exchange(MessageBatches& batches, CollectiveCheck& agree, Overlaps& result);

   private:
    MemoryMeter& meter_;
    std::vector<Overlaps> for_rank_;
};

/// Returns the rows of a result as a message, and the rows of such a message.
CRUMPLE_API std::vector<std::byte> packed_rows(const Overlaps& rows);
CRUMPLE_API Overlaps unpacked_rows(std::span<const std::byte> message);

/// Appends the rows of several results of the same query to `merged`, by ascending pairs of bodies.
CRUMPLE_API void merge_rows(std::span<const Overlaps> results, Overlaps& merged);

}  // namespace crumple::distribute
