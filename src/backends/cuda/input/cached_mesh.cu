#include "backends/cuda/input/cached_mesh.h"

#include "backends/cuda/input/index_reader.h"

namespace crumple::cuda {
namespace {

template <class Reader>
__global__ void compare_corners_kernel(Reader read, std::size_t corners, const std::int32_t* known,
                                       Counters* counters) {
    for (std::size_t i = grid_thread(); i < corners; i += grid_stride())
        if (read(i / 3, static_cast<int>(i % 3)) != known[i])
            atomicMin(&counters->changed, static_cast<unsigned long long>(i));
}

__global__ void compare_kernel(const std::int32_t* given, const std::int32_t* known, std::size_t n,
                               Counters* counters) {
    for (std::size_t i = grid_thread(); i < n; i += grid_stride())
        if (given[i] != known[i]) atomicMin(&counters->changed, static_cast<unsigned long long>(i));
}

}  // namespace

void compare(const Geometry& geometry, cudaStream_t stream, const Shape& shape, const CachedMesh& known,
             Counters* counters) {
    const auto launch = [&](std::size_t n) { return Launch{stream, geometry.blocks(n), geometry.threads}; };
    const auto corners = 3 * static_cast<std::size_t>(known.faces);
    with_reader(shape.triangles, [&](auto reader) {
        launch(corners)(compare_corners_kernel<decltype(reader)>, reader, corners, known.corners, counters);
    });
    if (shape.edges && !shape.edges->empty()) {
        static_assert(sizeof(Edge) == 2 * sizeof(std::int32_t));
        const std::size_t n = 2 * shape.edges->size();
        launch(n)(compare_kernel, reinterpret_cast<const std::int32_t*>(shape.edges->data()),
                  reinterpret_cast<const std::int32_t*>(known.edges), n, counters);
    }
    if (shape.points && !shape.points->empty()) {
        const std::size_t n = shape.points->size();
        launch(n)(compare_kernel, shape.points->data(), known.points, n, counters);
    }
}

}  // namespace crumple::cuda
