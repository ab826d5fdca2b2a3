#include "backends/cuda/features/feature_rows.h"

#include <bit>

#include "backends/cuda/stages/output_kernel.h"

namespace crumple::cuda {
namespace {

__global__ void bucket_kernel(FeatureHits hits, FeatureOutput out) {
    const unsigned long long n = hits.list.filled();
    for (unsigned long long i = grid_thread(); i < n; i += grid_stride()) {
        const RankedHit hit = hits.list.data[i];
        const unsigned long long place = out.offsets[hit.first] + hit.rank;
        if (place < out.capacity) out.second[place] = static_cast<std::uint64_t>(hit.second) << 32 | i;
    }
}

__device__ unsigned long long bits_of(double value) { return std::bit_cast<unsigned long long>(value); }
__device__ unsigned long long pair_of(const RankedHit& hit) {
    return static_cast<unsigned long long>(hit.first) << 32 | static_cast<std::uint32_t>(hit.second);
}

// Finds the earliest impact in three launches: the least value, then the first pair with it, then its flag.
template <int turn>
__global__ void earliest_kernel(List<RankedHit> hits, Earliest* earliest, const Counters* counters, Counters* told) {
    if (told && grid_thread() == 0) *told = *counters;
    const unsigned long long n = hits.filled();
    for (unsigned long long i = grid_thread(); i < n; i += grid_stride()) {
        const RankedHit hit = hits.data[i];
        if constexpr (turn == 0) {
            atomicMin(&earliest->value, bits_of(hit.value));
        } else if (bits_of(hit.value) == earliest->value) {
            if constexpr (turn == 1)
                atomicMin(&earliest->pair, pair_of(hit));
            else if (pair_of(hit) == earliest->pair)
                earliest->flag = hit.flag;
        }
    }
}

}  // namespace

template void make_offsets(const Geometry&, cudaStream_t, std::size_t, const FeatureOutput&, Counters*);
template void order_buckets(const Geometry&, cudaStream_t, std::size_t, const FeatureOutput&, Counters*, Counters*);

void FeatureOutput::cut(ArenaLayout& c, const FirstOfKind& features, std::size_t most) {
    RowsByKind::cut(c, features, most, true);
    second = c.take<Key>(most);
}

void write_feature_rows(const Geometry& geometry, cudaStream_t stream, const FeatureHits& hits,
                        const FeatureOutput& output, Counters* counters, Counters* told) {
    make_offsets(geometry, stream, output.firsts.all(), output, counters);
    Launch{stream, geometry.blocks(hits.list.capacity), geometry.threads}(bucket_kernel, hits, output);
    order_buckets(geometry, stream, output.firsts.all(), output, counters, told);
}

void clear(BatchedClear& batch, Earliest* earliest) { batch.add(earliest, sizeof *earliest, ~0u); }

void find_earliest(const Geometry& geometry, cudaStream_t stream, const FeatureHits& hits, Earliest* earliest,
                   Counters* counters, Counters* told) {
    const Launch launch{stream, geometry.blocks(hits.list.capacity), geometry.threads};
    launch(earliest_kernel<0>, hits.list, earliest, counters, nullptr);
    launch(earliest_kernel<1>, hits.list, earliest, counters, nullptr);
    launch(earliest_kernel<2>, hits.list, earliest, counters, told);
}

}  // namespace crumple::cuda
