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

/// Numbers of pairs and of faces from which on the device is used. These are estimates: for a pair the host takes 0.2
/// to 0.5 us on one thread, for a face some 10 ns; a call takes some 50 us. Only tests change them.
extern std::size_t least_crossed_pairs, least_summed_faces;

class DeviceOverlaps final : public OverlapDevice {
   public:
    explicit DeviceOverlaps(BackendState& state) : state_(state), surfaces_(state.meter), lists_(state.meter) {}

    std::size_t least_pairs() const override { return least_crossed_pairs; }
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
