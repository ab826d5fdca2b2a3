#pragma once

// Communication between ranks: the interface that all of src/distributed uses. Implemented for threads of one process
// (in_process.h) and for MPI (mpi/mpi_transport.h).
//
// Every call is collective: all ranks make the same calls in the same order. A call that fails on one rank may leave
// the others waiting, so a collective error check (collective_check.h) must follow whatever can fail on one rank alone
// (input, memory), before the next call.

#include <cstddef>
#include <cstdint>
#include <span>

namespace crumple::distribute {

enum class Reduction : std::uint8_t { min, max, sum };

/// Message to a rank, or the buffer for a message from it.
struct Outgoing {
    int rank;
    std::span<const std::byte> bytes;
};
struct Incoming {
    int rank;
    std::span<std::byte> bytes;
};

class Transport {
   public:
    virtual ~Transport() = default;
    virtual int rank() const = 0;
    virtual int size() const = 0;

    /// Replaces each number by the minimum, maximum or sum over all ranks. Integers only, so that the order of the
    /// ranks does not matter.
    virtual void reduce(std::span<std::int64_t> numbers, Reduction how) = 0;
    /// Copies the root's bytes to all ranks. The size must be the same on all ranks.
    virtual void broadcast(std::span<std::byte> bytes, int root) = 0;
    /// Sends the number to[r] to each rank r. from[s] receives the number that rank s sends to this rank.
    virtual void all_to_all(std::span<const std::int64_t> to, std::span<std::int64_t> from) = 0;
    /// Sends at most one message to each other rank, and receives at most one from each. Both sides must know its size,
    /// at most 2^30 bytes; empty messages are not sent.
    virtual void exchange(std::span<const Outgoing> out, std::span<const Incoming> in) = 0;
};

}  // namespace crumple::distribute
