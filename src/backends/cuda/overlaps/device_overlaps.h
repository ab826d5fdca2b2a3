#pragma once

// Overlaps of bodies on a device (backends/overlap_device.h): uploads surfaces and pairs, runs the kernels
// (crossing_terms.h), and downloads crossings and sums, which the host adds in fixed point.
//
//   surfaces, rows, pairs --upload--> crossings --> sums --download--> crossings of each pair, sums of each row
//   counted faces --upload--> sums --download--> sums

#include <cstddef>
#include <mutex>
#include <span>
#include <vector>

#include "backends/cuda/engine/backend_state.h"
#include "backends/cuda/overlaps/crossing_terms.h"

namespace crumple::cuda {

/// Numbers of pairs and of faces from which on the device is used, plus one pair for so many bytes of surfaces, which
/// are uploaded. These are estimates: on one thread the host takes 0.2 us for a pair and some 10 ns for a face; a call
/// takes some 50 us, an upload 1 ms for 10 MB. Only tests change them.
extern std::size_t least_crossed_pairs, surface_bytes_per_pair, least_summed_faces;

class DeviceOverlaps final : public OverlapDevice {
   public:
    explicit DeviceOverlaps(BackendState& state) : state_(state), surfaces_(state.meter), lists_(state.meter) {}

    std::size_t least_pairs(std::size_t points, std::size_t faces) const override {
        const std::size_t bytes = points * sizeof(Vec3d) + 3 * faces * sizeof(std::int32_t);
        return least_crossed_pairs + bytes / surface_bytes_per_pair;
    }
    std::size_t least_faces() const override { return least_summed_faces; }
    bool cross(std::span<const DeviceSurface> surfaces, std::span<const CrossedRow> rows, std::span<const Pair> pairs,
               bool numbers, BatchCrossings& crossings) override;
    bool add_faces(std::int32_t surface, std::span<const CountedFace> faces, const Vec3d& origin,
                   std::vector<VolumeTerms<Enclosed>>& sums) override;
    void end_batch() override;
    void release();

   private:
    void upload(std::span<const DeviceSurface> surfaces);

    BackendState& state_;
    std::mutex mutex_;                     ///< one call at a time uses the lists
    Block surfaces_, lists_;               ///< arrays of surfaces; lists of one call
    std::vector<SurfaceArrays> uploaded_;  ///< by surface of the batch
};

}  // namespace crumple::cuda
