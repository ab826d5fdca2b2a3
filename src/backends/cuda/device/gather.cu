#include "backends/cuda/device/gather.h"

namespace crumple::cuda {
namespace {

__global__ void gather_kernel(PreparedScene scene, const Pair* pairs, std::size_t n, std::int32_t second,
                              Triangle* triangles) {
    for (std::size_t i = grid_thread(); i < 2 * n; i += grid_stride()) {
        const Pair pair = pairs[i / 2];
        triangles[i] = scene.triangle(i % 2 ? pair.b + second : pair.a);
    }
}

}  // namespace

void gather(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const Pair* pairs, std::size_t n,
            std::int32_t second, Triangle* triangles) {
    Launch{stream, geometry.blocks(2 * n), geometry.threads}(gather_kernel, scene, pairs, n, second, triangles);
}

}  // namespace crumple::cuda
