#pragma once

// Exact coordinates of pairs, brought to the host for what only the host can do: rational arithmetic.

#include <algorithm>
#include <vector>

#include "backends/cuda/device/memory.h"
#include "backends/cuda/device/runtime.h"
#include "crumple/intersections.h"
#include "scene/prepared_scene.h"

namespace crumple::cuda {

/// The triangles of pairs [0, n), a's and b's in turn. `second` is added to b.
void gather(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const Pair* pairs, std::size_t n,
            std::int32_t second, Triangle* triangles);

class Gathered {
   public:
    Gathered(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, MemoryMeter& meter)
        : geometry_(geometry), stream_(stream), scene_(scene), block_(meter) {}

    /// Calls use(i, a, b) for the triangles of each pair, a few thousand pairs at a time.
    template <class Use>
    void each(const Pair* pairs, std::size_t n, std::int32_t second, Use use) {
        std::vector<Triangle> host(2 * std::min(n, batch));
        Triangle* device = nullptr;
        lay_out(block_, [&](Cutter& c) { device = cut(c, n); });
        // A Triangle's last bytes hold nothing, and are copied all the same.
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

    /// The device memory that each() takes.
    static Triangle* cut(Cutter& cutter, std::size_t n) { return cutter.take<Triangle>(2 * std::min(n, batch)); }

   private:
    static constexpr std::size_t batch = 4096;

    const Geometry& geometry_;
    cudaStream_t stream_;
    const PreparedScene& scene_;
    Block block_;
};

}  // namespace crumple::cuda
