#pragma once

// Download of the exact coordinates of pairs of triangles, for rational arithmetic, which only the host can do.

#include <algorithm>
#include <vector>

#include "backends/cuda/device/memory.h"
#include "backends/cuda/device/runtime.h"
#include "crumple/intersections.h"
#include "scene/prepared_scene.h"

namespace crumple::cuda {

/// Writes the triangles of pairs [0, n): a and b alternately, 2 n in all. `second` is added to each b: the number of
/// triangles of the first mesh if b counts from the second mesh's first triangle, else 0.
void gather(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const Pair* pairs, std::size_t n,
            std::int32_t second, Triangle* triangles);

class Gathered {
   public:
    Gathered(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, MemoryMeter& meter)
        : geometry_(geometry), stream_(stream), scene_(scene), block_(meter) {}

    /// Downloads the triangles of all pairs, a few thousand pairs at a time, and calls use(i, a, b) for each pair.
    template <class Use>
    void each(const Pair* pairs, std::size_t n, std::int32_t second, Use use) {
        std::vector<Triangle> host(2 * std::min(n, batch));
        Triangle* device = nullptr;
        place_arrays(block_, [&](ArenaLayout& c) { device = cut(c, n); });
        // Initialises the padding of the Triangles, which is downloaded, too.
        fill(stream_, device, 0, host.size() * sizeof(Triangle));
        for (std::size_t begin = 0; begin < n; begin += batch) {
            const std::size_t count = std::min(batch, n - begin);
            gather(geometry_, stream_, scene_, pairs + begin, count, second, device);
            CRUMPLE_CUDA(
                cudaMemcpyAsync(host.data(), device, 2 * count * sizeof(Triangle), cudaMemcpyDeviceToHost, stream_));
            CRUMPLE_CUDA(cudaStreamSynchronize(stream_));
            for (std::size_t i = 0; i < count; ++i) use(begin + i, host[2 * i], host[2 * i + 1]);
        }
    }

    /// Takes the device memory that each() needs for n pairs from the cutter.
    static Triangle* cut(ArenaLayout& cutter, std::size_t n) { return cutter.take<Triangle>(2 * std::min(n, batch)); }

   private:
    static constexpr std::size_t batch = 4096;

    const Geometry& geometry_;
    cudaStream_t stream_;
    const PreparedScene& scene_;
    Block block_;
};

}  // namespace crumple::cuda
