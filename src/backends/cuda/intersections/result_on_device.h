#pragma once

// Result of an intersection query on the device: its arrays, its contacts, and its copy to the host.

#include "backends/cuda/device/memory.h"
#include "backends/cuda/input/world_names.h"
#include "backends/cuda/intersections/device_contacts.h"
#include "backends/cuda/stages/output.h"
#include "base/cancellation.h"
#include "crumple/intersections.h"

namespace crumple::cuda {

class ResultOnDevice {
   public:
    ResultOnDevice(const Geometry& geometry, cudaStream_t stream, MemoryMeter& meter)
        : geometry_(geometry), stream_(stream), meter_(meter), contact_block_(meter) {}

    OutputArrays output{};
    unsigned long long total = 0;  ///< pairs
    WorldNames names;              ///< tables for naming worlds and bodies, in results about worlds; set before cut()

    /// Takes the arrays for so many pairs from the cutter.
    void cut(ArenaLayout& cutter, const PreparedScene& scene, std::size_t pairs);
    /// Returns the bytes that these arrays and make_contacts() take.
    static std::size_t bytes(const PreparedScene& scene, std::size_t pairs, bool contacts);

    /// Adds the arrays that write() requires cleared to `batch`: flags, and the counts by first triangle, which
    /// `narrow` then fills. Counters::parts has to be cleared, too.
    void clear(BatchedClear& batch, const PreparedScene& scene) const;
    /// Turns the listed hits into the result. output.offsets must contain the number of hits of each first triangle.
    /// Copies the counters to the last argument, host memory that the device can write, unless it is null.
    void write(const PreparedScene& scene, const List<Hit>& hits, Counters* counters, Counters* told);
    /// Computes the contacts of the result and leaves them on the device. Returns how many the host had to round.
    std::int64_t make_contacts(const PreparedScene& scene, Cancellation& cancellation);

    /// Returns a view of the result on the device: about the scene, or about worlds if there are `names`.
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
    unsigned long long points_ = 0;  ///< number of points of all contacts
};

}  // namespace crumple::cuda
