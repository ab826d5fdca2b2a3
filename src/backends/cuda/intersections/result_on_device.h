#pragma once

// A result on the device, from its arrays to the host's copy.

#include "backends/cuda/device/memory.h"
#include "backends/cuda/input/world_names.h"
#include "backends/cuda/intersections/device_contacts.h"
#include "backends/cuda/stages/output.h"
#include "base/cancellation.h"
#include "crumple/intersections.h"

namespace crumple::cuda {

class Answer {
   public:
    Answer(const Geometry& geometry, cudaStream_t stream, MemoryMeter& meter)
        : geometry_(geometry), stream_(stream), meter_(meter), contact_block_(meter) {}

    OutputArrays output{};
    unsigned long long total = 0;  ///< pairs
    WorldNames names;              ///< of a scene of worlds that are to be told of; set before cut()

    /// Cuts the arrays of so many pairs.
    void cut(Cutter& cutter, const PreparedScene& scene, std::size_t pairs);
    /// Bytes that these and make_contacts take.
    static std::size_t bytes(const PreparedScene& scene, std::size_t pairs, bool contacts);

    /// What write() finds cleared, beside the counter of parts: flags, and numbers by first triangle, which are
    /// counted before.
    void clear(Clearing& clearing, const PreparedScene& scene) const;
    /// Turns listed hits, counted by first triangle in output.offsets, into the answer; `told` as order_buckets() has
    /// it.
    void write(const PreparedScene& scene, const List<Hit>& hits, Counters* counters, Counters* told);
    /// Computes the contacts of the answer and leaves them on the device. Returns how many the host had to round.
    std::int64_t make_contacts(const PreparedScene& scene, Cancellation& cancellation);

    /// The result of a scene, or that of worlds if there are names.
    DeviceIntersections show(const PreparedScene& scene, bool contacts) const;
    void copy_to(const PreparedScene& scene, bool contacts, Intersections& result);

    void release_contacts() { contact_block_.release(); }

   private:
    void decide_open(const PreparedScene& scene, std::size_t n, std::int32_t second, Cancellation& cancellation);

    const Geometry& geometry_;
    cudaStream_t stream_;
    MemoryMeter& meter_;
    Block contact_block_;
    WorldArrays of_worlds_{};
    ContactArrays contacts_{};
    unsigned long long points_ = 0;  ///< of all contacts
};

}  // namespace crumple::cuda
