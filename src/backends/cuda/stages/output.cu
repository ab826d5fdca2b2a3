#include "backends/cuda/stages/output.h"

#include "backends/cuda/stages/output_kernel.h"

namespace crumple::cuda {
namespace {

__global__ void bucket_kernel(List<Hit> hits, std::int32_t second, OutputArrays out) {
    const unsigned long long n = hits.filled();
    for (unsigned long long i = grid_thread(); i < n; i += grid_stride()) {
        const Hit hit = hits.data[i];
        const unsigned long long place = out.offsets[hit.a] + hit.rank;
        if (place < out.capacity) out.bucketed[place] = {hit.a, hit.b - second};
    }
}

}  // namespace

std::size_t offset_tiles(std::size_t firsts) { return firsts / detail::offset_tile + 2; }

std::size_t whole_words(std::size_t flags) { return (flags + 3) / 4 * 4; }

std::size_t part_capacity(std::size_t pairs) { return pairs / detail::short_row + pairs / detail::part_pairs + 1; }

template void make_offsets(const Geometry&, cudaStream_t, std::size_t, const OutputArrays&, Counters*);
template void list_parts(const Geometry&, cudaStream_t, std::size_t, const OutputArrays&, Counters*);
template void order_buckets(const Geometry&, cudaStream_t, std::size_t, const OutputArrays&, Counters*, Counters*);

void fill_buckets(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const List<Hit>& hits,
                  const OutputArrays& output) {
    const auto second = static_cast<std::int32_t>(scene.between ? scene.triangles[0] : 0);
    Launch{stream, geometry.blocks(hits.capacity), geometry.threads}(bucket_kernel, hits, second, output);
}

void clear_flags(BatchedClear& batch, const PreparedScene& scene, const OutputArrays& output) {
    batch.add(output.hit, whole_words(static_cast<std::size_t>(scene.triangles[0])));
    if (scene.between) batch.add(output.hit_second, whole_words(static_cast<std::size_t>(scene.triangles[1])));
}

}  // namespace crumple::cuda
