#pragma once

// How ranks talk: the calls that all of src/distribute is written over. Two transports have them: threads of one
// process (in_process.h) and MPI (mpi/mpi_transport.h).
//
// Every call is collective: all ranks make the same calls in the same order. A call that fails on one rank may leave
// the others waiting, so whatever can fail by itself (input, memory) is settled before by an agreement (agreement.h).

#include <cstddef>
#include <cstdint>
#include <span>

namespace crumple::distribute {

enum class Reduction : std::uint8_t { min, max, sum };

/// Bytes on their way to a rank, or the place for those from it.
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

    /// Replaces each number by the least, the largest or the sum of what the ranks have at its place. Integers alone:
    /// the order of the ranks changes nothing.
    virtual void reduce(std::span<std::int64_t> numbers, Reduction how) = 0;
    /// All ranks get the root's bytes; they know how many.
    virtual void broadcast(std::span<std::byte> bytes, int root) = 0;
    /// Rank r gets the number that each rank has at place r: from[s] there is to[r] of rank s.
    virtual void all_to_all(std::span<const std::int64_t> to, std::span<std::int64_t> from) = 0;
    /// Sends to some ranks and receives from some, at most one message each, none to itself; both sides know how long
    /// it is, and empty ones are left out. At most 2^30 bytes each.
    virtual void exchange(std::span<const Outgoing> out, std::span<const Incoming> in) = 0;
};

}  // namespace crumple::distribute
