#include "backends/cuda/stages/sort.h"

#include "backends/cuda/device/block_counter.h"
#include "backends/cuda/stages/align.h"

namespace crumple::cuda {
namespace {

__device__ std::uint32_t bin_of(float x, const Frame& frame) {
    const float b = (x - frame.base) * frame.scale;  // monotone, so overlapping intervals have overlapping bins
    return b > 0 ? (b < bins - 1 ? static_cast<std::uint32_t>(b) : bins - 1) : 0;
}

// Writes the exclusive prefix sums of a warp's counts, starting at `first`. Returns `first` plus the sum of all.
__device__ std::uint32_t sum_of_32_bins(std::uint32_t* place, std::uint32_t count, std::uint32_t first) {
    std::uint32_t sum = count;
    for (unsigned lanes = 1; lanes < 32; lanes *= 2) {
        const std::uint32_t before = __shfl_up_sync(whole_warp, sum, lanes);
        if (threadIdx.x % 32 >= lanes) sum += before;
    }
    *place = first + sum - count;
    return first + __shfl_sync(whole_warp, sum, 31);
}

// Turns a leaf's counts by bin into first rows, by one warp. It loads several rounds of counts ahead, so that it waits
// for memory once for all of them.
__device__ void sum_bins(std::uint32_t* bin_first, std::uint32_t first) {
    constexpr unsigned ahead = 16;
    const unsigned lane = threadIdx.x % 32;
    std::uint32_t counts[ahead];
    for (unsigned b = lane; b < bins; b += 32 * ahead) {
        for (unsigned k = 0; k < ahead; ++k) counts[k] = bin_first[b + 32 * k];
        for (unsigned k = 0; k < ahead; ++k) first = sum_of_32_bins(bin_first + b + 32 * k, counts[k], first);
    }
    if (lane == 0) bin_first[bins] = first;
}
// Finds the first and last bin of each member, and its rank among the members with the same first bin. A warp's members
// belong to one leaf, and the warp that bins the last members of a leaf sums up its bins, which saves a kernel. Fences
// on both sides of the counter ensure that this warp sees what the others have counted. Lane 0 executes the first
// fence, after a __syncwarp, so that the fence covers the counts of the other lanes.
template <class T, class Primitive>
__global__ void bin_kernel(PreparedScene scene, Primitive primitive, const Row<T>* rows, int leaves,
                           Segments members_of, Members members, Frames frames, Sorted sorted) {
    const unsigned lane = threadIdx.x % 32;
    const auto n = static_cast<std::size_t>(leaves);
    for (unsigned long long m = grid_thread(); m < members_of.first[n]; m += grid_stride()) {
        const std::size_t leaf = segment_of(m, members_of.first, n);
        const unsigned long long begin = members_of.first[leaf], end = members_of.end(leaf);
        std::uint32_t* bin_first = sorted.bin_first + leaf * (bins + 1);
        const bool valid = m < end;
        if (valid) {
            const Frame frame = frames[leaf];
            const std::int32_t t = members.triangle[m];
            Vec3d p[Primitive::corners];
            const auto member = primitive.in_frame(rows, scene.corners + 3 * static_cast<std::size_t>(t), t, frame, p);
            const std::uint32_t first = bin_of(member.low.x - frame.margin, frame);
            const std::uint32_t last = bin_of(member.high.x + frame.margin, frame);
            sorted.bin[m] = first | last << 16;
            sorted.rank[m] = atomicAdd(&bin_first[first], 1u);
        }
        const auto here = static_cast<unsigned>(__popc(__ballot_sync(whole_warp, valid)));
        __syncwarp();
        unsigned before = 0;
        if (lane == 0 && here) {
            __threadfence();
            before = atomicAdd(&sorted.binned[leaf], here);
        }
        before = __shfl_sync(whole_warp, before, 0);
        if (here == 0 || before + here < end - begin) continue;
        __threadfence();
        __syncwarp();
        sum_bins(bin_first, static_cast<std::uint32_t>(begin));
    }
}

// Lists the units of each group of 32 rows. A group belongs to one warp and one leaf. The warps of a block reserve
// places for their units together, so they stay in the loop together.
__global__ void unit_kernel(int leaves, Segments members_of, Sorted sorted, List<SweepUnit> units) {
    const unsigned lane = threadIdx.x % 32;
    const auto n = static_cast<std::size_t>(leaves);
    const unsigned long long rows = members_of.first[n];
    for (unsigned long long row = grid_thread(); row - threadIdx.x < rows; row += grid_stride()) {
        const bool exists = row < rows;  // the same for all lanes: lists begin and end at multiples of 32
        const auto rows_end =
            exists ? static_cast<std::uint32_t>(members_of.end(segment_of(row, members_of.first, n))) : 0;
        std::uint32_t end = row < rows_end ? sorted.row[row].end : 0;
        for (int lanes = 16; lanes > 0; lanes /= 2) end = max(end, __shfl_xor_sync(whole_warp, end, lanes));
        const auto first = static_cast<std::uint32_t>(row) - lane, column = first + 1;
        const unsigned wanted = end > column ? (end - column + unit_columns - 1) / unit_columns : 0;
        const unsigned long long place = reserve_by_block(wanted, units.count, dynamic_shared<BlockShared>());
        for (unsigned u = lane; u < wanted && place + u < units.capacity; u += 32) {
            const std::uint32_t begin = column + u * unit_columns;
            units.data[place + u] = {first, rows_end, begin, min(begin + unit_columns, end)};
        }
    }
}

}  // namespace

void clear(BatchedClear& batch, const Sorted& sorted, int leaves) {
    const auto n = static_cast<std::size_t>(leaves);
    batch.add(sorted.bin_first, n * (bins + 1) * sizeof *sorted.bin_first);
    batch.add(sorted.binned, n * sizeof *sorted.binned);
}

template <class Primitive>
void bin_members(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const Primitive& primitive,
                 const Points& points, int leaves, const Segments& members_of, const Members& members,
                 const Frames& frames, const Sorted& sorted) {
    const auto bin = [&](const auto* rows, auto kernel) {
        Launch{stream, geometry.blocks(members.capacity), geometry.threads}(kernel, scene, primitive, rows, leaves,
                                                                            members_of, members, frames, sorted);
    };
    if (points.f)
        bin(points.f, bin_kernel<float, Primitive>);
    else
        bin(points.d, bin_kernel<double, Primitive>);
}
template void bin_members(const Geometry&, cudaStream_t, const PreparedScene&, const StaticTriangle&, const Points&,
                          int, const Segments&, const Members&, const Frames&, const Sorted&);
template void bin_members(const Geometry&, cudaStream_t, const PreparedScene&, const Widened<1>&, const Points&, int,
                          const Segments&, const Members&, const Frames&, const Sorted&);
template void bin_members(const Geometry&, cudaStream_t, const PreparedScene&, const Widened<2>&, const Points&, int,
                          const Segments&, const Members&, const Frames&, const Sorted&);

void list_units(const Geometry& geometry, cudaStream_t stream, int leaves, const Segments& members_of,
                std::size_t capacity, const Sorted& sorted, const List<SweepUnit>& units) {
    Launch{stream, geometry.blocks(capacity), geometry.threads, sizeof(BlockShared)}(unit_kernel, leaves, members_of,
                                                                                     sorted, units);
}

}  // namespace crumple::cuda
