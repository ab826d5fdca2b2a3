#include "backends/cuda/stages/subdivide.h"

#include <algorithm>
#include <bit>
#include <limits>

#include <cub/block/block_scan.cuh>

#include "backends/cuda/device/block_counter.h"
#include "backends/cuda/stages/align.h"

namespace crumple::cuda {
namespace {

constexpr int tile = 128;  ///< samples whose memberships one block sums

__host__ __device__ int tiles_of(const Fuzziness& f) { return (f.samples + tile - 1) / tile; }

struct Items {
    unsigned long long begin, end;
};
__device__ Items items_of(const Level& level, unsigned parent) {
    if (!level.items_of.first) return {0, level.items};
    return {level.items_of.first[parent], level.items_of.end(parent)};
}
__device__ std::int32_t triangle_of(const Level& level, unsigned long long item) {
    return level.triangle ? level.triangle[item] : static_cast<std::int32_t>(item);
}
__device__ Vec3f sample(const Level& level, const Items& items, const Ball* balls, unsigned i, unsigned samples) {
    const Ball ball = balls[triangle_of(level, items.begin + i * (items.end - items.begin) / samples)];
    return {ball.x, ball.y, ball.z};
}
__device__ unsigned sample_count(const Items& items, const Fuzziness& f) {
    const unsigned long long n = items.end - items.begin;
    return static_cast<unsigned>(n < static_cast<unsigned>(f.samples) ? n : static_cast<unsigned>(f.samples));
}

__global__ void start_kernel(Level level, const Ball* balls, Fuzziness f) {
    const unsigned parent = blockIdx.x;
    const Items items = items_of(level, parent);
    const unsigned samples = sample_count(items, f), fan_out = static_cast<unsigned>(level.fan_out);
    for (unsigned k = threadIdx.x; k < fan_out; k += blockDim.x) {
        const Vec3f p = samples ? sample(level, items, balls, (2 * k + 1) * samples / (2 * fan_out), samples) : Vec3f{};
        level.next_centre[parent * fan_out + k] = {p.x, p.y, p.z, 0};
    }
}

struct SumShared {
    Row<float> point[tile];  // samples
    Row<float> centre[max_fan_out];
    float weight[tile][max_fan_out + 1];  // membership^t; one more column to avoid bank conflicts
};

// Computes the memberships (eq. 3) of a tile of samples of one parent, and the sums of eq. 4 over the tile.
__global__ void sum_kernel(Level level, const Ball* balls, Fuzziness f, Row<float>* partial) {
    auto& shared = dynamic_shared<SumShared>();
    const unsigned parent = blockIdx.y, fan_out = static_cast<unsigned>(level.fan_out);
    const bool done = level.moved[parent] <= f.stop;
    const Items items = items_of(level, parent);
    const unsigned samples = sample_count(items, f), begin = blockIdx.x * tile;
    const unsigned here = done || begin >= samples ? 0 : min(samples - begin, static_cast<unsigned>(tile));
    for (unsigned k = threadIdx.x; k < fan_out; k += blockDim.x)
        shared.centre[k] = level.next_centre[parent * fan_out + k];
    __syncthreads();
    const float distance_power = 1.0f / (f.t - 1.0f);
    for (unsigned i = threadIdx.x; i < here; i += blockDim.x) {
        const Vec3f p = sample(level, items, balls, begin + i, samples);
        // A triangle with an index out of range has its centroid at 0, which does no harm.
        shared.point[i] = {p.x, p.y, p.z, 0};
        float total = 0;
        for (unsigned k = 0; k < fan_out; ++k) {
            const float dx = p.x - shared.centre[k].x, dy = p.y - shared.centre[k].y, dz = p.z - shared.centre[k].z;
            float w = 1.0f / (dx * dx + dy * dy + dz * dz + 1e-30f);
            if (f.t != 2.0f) w = powf(w, distance_power);
            shared.weight[i][k] = w;
            total += w;
        }
        const float scale = 1.0f / total;
        for (unsigned k = 0; k < fan_out; ++k) {
            const float u = shared.weight[i][k] * scale;
            shared.weight[i][k] = f.t == 2.0f ? u * u : powf(u, f.t);
        }
    }
    __syncthreads();
    for (unsigned k = threadIdx.x; k < fan_out; k += blockDim.x) {
        Row<float> sum{0, 0, 0, 0};
        for (unsigned i = 0; i < here; ++i) {
            const float w = shared.weight[i][k];
            sum.x += w * shared.point[i].x;
            sum.y += w * shared.point[i].y;
            sum.z += w * shared.point[i].z;
            sum.unused += w;
        }
        partial[(parent * gridDim.x + blockIdx.x) * fan_out + k] = sum;
    }
}

struct MoveShared {
    unsigned moved;
};

// Moves the centres to their weighted means (eq. 4).
__global__ void move_kernel(Level level, const Row<float>* partial, unsigned tiles, float stop) {
    auto& shared = dynamic_shared<MoveShared>();
    const unsigned parent = blockIdx.x, fan_out = static_cast<unsigned>(level.fan_out);
    const bool done = level.moved[parent] <= stop;
    if (threadIdx.x == 0) shared.moved = 0;
    __syncthreads();
    for (unsigned k = threadIdx.x; !done && k < fan_out; k += blockDim.x) {
        Row<float> sum{0, 0, 0, 0};
        for (unsigned i = 0; i < tiles; ++i) {
            const Row<float> part = partial[(parent * tiles + i) * fan_out + k];
            sum.x += part.x, sum.y += part.y, sum.z += part.z, sum.unused += part.unused;
        }
        if (!(sum.unused > 0)) continue;
        const Vec3f next{sum.x / sum.unused, sum.y / sum.unused, sum.z / sum.unused};
        Row<float>& centre = level.next_centre[parent * fan_out + k];
        const float moved = largest(abs(next - Vec3f{centre.x, centre.y, centre.z}));
        if (!(moved < INFINITY)) continue;
        centre = {next.x, next.y, next.z, 0};
        atomicMax(&shared.moved, __float_as_uint(moved));  // bits of floats >= 0 have their order
    }
    __syncthreads();
    if (threadIdx.x == 0 && !done) level.moved[parent] = __uint_as_float(shared.moved);
}

struct MembersShared {
    Row<float> centre[max_fan_out];
    float bisector[max_fan_out][max_fan_out + 1];  // bisector_radius_factor(); one more column to avoid bank conflicts
    unsigned count[max_fan_out];
    BlockShared block;
    unsigned long long place[max_fan_out];
    Row<float> origin[max_fan_out];  // origin and, as `unused`, LeafFrame::big of the children's frames
    unsigned reach[max_fan_out];
};

// Returns a mask of the children whose Voronoi cell may contain a point of the ball; 0 if the radius is NaN.
__device__ std::uint64_t children_of(const Ball& ball, const MembersShared& shared, int fan_out) {
    if (!(ball.r >= 0)) return 0;
    const Row<float>* centre = shared.centre;
    float best = INFINITY;
    int nearest = 0;
    const auto distance2 = [&](int k) {
        const float dx = ball.x - centre[k].x, dy = ball.y - centre[k].y, dz = ball.z - centre[k].z;
        return dx * dx + dy * dy + dz * dz;
    };
    for (int k = 0; k < fan_out; ++k) {
        const float d2 = distance2(k);
        if (d2 < best) best = d2, nearest = k;
    }
    const float* reach = shared.bisector[nearest];
    std::uint64_t mask = 0;
    for (int k = 0; k < fan_out; ++k)
        if (joins(distance2(k), best, ball.r, reach[k])) mask |= std::uint64_t{1} << k;
    return mask;
}

// Finds the children of all items and lists the members. Each block counts its own members first, so that it reserves
// places by one global atomic per child, not one per member. It counts in 32 bits, the width of native atomic additions
// in shared memory.
template <bool reaching, class Primitive>
__global__ void members_kernel(Level level, const Ball* balls, std::uint64_t listed, Members members, ExtentInput how,
                               Primitive primitive, unsigned long long* total, unsigned long long* unplaced) {
    auto& shared = dynamic_shared<MembersShared>();
    const unsigned parent = blockIdx.y, fan_out = static_cast<unsigned>(level.fan_out), first_child = parent * fan_out;
    for (unsigned k = threadIdx.x; k < fan_out; k += blockDim.x) {
        shared.centre[k] = level.centre[first_child + k];
        shared.count[k] = 0;
        if constexpr (!reaching) continue;
        const LeafFrame& frame = how.frames.binned[first_child + k];
        shared.origin[k] = {frame.origin.x, frame.origin.y, frame.origin.z, frame.big};
        shared.reach[k] = 0;
    }
    __syncthreads();
    for (unsigned pair = threadIdx.x; pair < fan_out * fan_out; pair += blockDim.x) {
        const Row<float> v = shared.centre[pair / fan_out], w = shared.centre[pair % fan_out];
        shared.bisector[pair / fan_out][pair % fan_out] = bisector_radius_factor({w.x - v.x, w.y - v.y, w.z - v.z});
    }
    __syncthreads();
    const Items items = items_of(level, parent);
    for (unsigned long long i = items.begin + grid_thread(); i < items.end; i += grid_stride()) {
        const std::uint64_t mask = children_of(balls[triangle_of(level, i)], shared, level.fan_out);
        level.mask[i] = mask;
        for (std::uint64_t left = mask & listed; left; left &= left - 1)
            atomicAdd(&shared.count[__ffsll(static_cast<long long>(left)) - 1], 1u);
    }
    __syncthreads();
    unsigned long long own_members = 0;
    for (unsigned k = threadIdx.x; k < fan_out; k += blockDim.x) {
        const unsigned long long count = shared.count[k];
        if (!count) continue;
        const unsigned long long begin = level.members_of.first[first_child + k],
                                 buffer = level.members_of.first[first_child + k + 1] - begin;
        const unsigned long long before = atomicAdd(&level.members_of.count[first_child + k], count);
        shared.place[k] = begin + before;
        shared.count[k] = 0;
        own_members += count;
        if (before + count > buffer) atomicAdd(unplaced, before < buffer ? before + count - buffer : count);
    }
    add_by_block(own_members, total, shared.block);  // also a barrier for shared.place
    for (unsigned long long i = items.begin + grid_thread(); i < items.end; i += grid_stride()) {
        for (std::uint64_t left = level.mask[i] & listed; left; left &= left - 1) {
            const int k = __ffsll(static_cast<long long>(left)) - 1;
            const unsigned child = first_child + static_cast<unsigned>(k);
            const unsigned long long place = shared.place[k] + atomicAdd(&shared.count[k], 1u);
            if (place >= level.members_of.first[child + 1]) continue;
            const std::int32_t t = triangle_of(level, i);
            members.triangle[place] = t;
            members.item[place] = static_cast<std::uint32_t>(i);
            if constexpr (!reaching) continue;
            const Row<float> origin = shared.origin[k];
            float reach = ball_extent(balls[t], {origin.x, origin.y, origin.z});
            if (reach > origin.unused)
                reach = exact_extent(how.scene, primitive, how.points, t, how.frames.binned[child], reach);
            atomicMax(&shared.reach[k], __float_as_uint(reach));
        }
    }
    if constexpr (!reaching) return;
    __syncthreads();
    for (unsigned k = threadIdx.x; k < fan_out; k += blockDim.x)
        if (shared.reach[k]) atomicMax(&how.frames.reach[first_child + k], shared.reach[k]);
}

template <int threads>
struct PlacesShared {
    typename cub::BlockScan<unsigned long long, threads>::TempStorage scan;
};

// Computes prefix sums of the children's sizes. One block does this, 256 children at a time: a single world has at most
// 4096 children, and all worlds together have at most max_leaves. An empty child gets no places, since it rarely has
// members in the next pass.
template <int threads>
__global__ void places_kernel(Level level, unsigned long long capacity, unsigned long long* wanted) {
    auto& shared = dynamic_shared<PlacesShared<threads>>();
    using Scan = cub::BlockScan<unsigned long long, threads>;
    const unsigned children = static_cast<unsigned>(level.children());
    unsigned long long before = 0;
    for (unsigned begin = 0; begin < children; begin += threads) {
        const unsigned child = begin + threadIdx.x;
        const unsigned long long count = child < children ? level.members_of.count[child] : 0;
        unsigned long long first, sum;
        __syncthreads();
        Scan(shared.scan).ExclusiveSum(count ? (count + count / 8 + 63) / 32 * 32 : 0, first, sum);
        if (child < children) level.next_first[child] = min(before + first, capacity / 32 * 32);
        before += sum;
    }
    if (threadIdx.x != 0) return;
    level.next_first[children] = min(before, capacity / 32 * 32);
    *wanted = before;
}

}  // namespace

void clear(BatchedClear& batch, const Level& level) {
    // Each pass iterates anew, so the last movement starts at infinity.
    batch.add(level.moved, static_cast<std::size_t>(level.parents) * sizeof *level.moved,
              std::bit_cast<unsigned>(std::numeric_limits<float>::infinity()));
}

void clear_members(BatchedClear& batch, const Level& level, unsigned long long* total, unsigned long long* unplaced) {
    batch.add(level.members_of.count, static_cast<std::size_t>(level.children()) * sizeof *level.members_of.count);
    batch.add(total, sizeof *total);
    batch.add(unplaced, sizeof *unplaced);
}

std::size_t fuzzy_scratch(const Level& level, const Fuzziness& fuzziness) {
    return static_cast<std::size_t>(level.children()) * static_cast<std::size_t>(tiles_of(fuzziness));
}

void fuzzy_c_means(const Geometry& geometry, cudaStream_t stream, const Level& level, const Ball* balls,
                   const Fuzziness& f, Row<float>* scratch) {
    const auto parents = static_cast<unsigned>(level.parents), tiles = static_cast<unsigned>(tiles_of(f));
    if (f.first) Launch{stream, parents, 64}(start_kernel, level, balls, f);
    for (int iteration = 0; iteration < f.iterations && level.fan_out > 1; ++iteration) {
        Launch{stream, {tiles, parents}, geometry.threads, sizeof(SumShared)}(sum_kernel, level, balls, f, scratch);
        Launch{stream, parents, 64, sizeof(MoveShared)}(move_kernel, level, scratch, tiles, f.stop);
    }
}

void make_members(const Geometry& geometry, cudaStream_t stream, const Level& level, std::size_t items,
                  const Ball* balls, std::uint64_t listed, const Members& members, const ExtentInput& reaching,
                  unsigned long long* total, unsigned long long* unplaced) {
    const auto parents = static_cast<unsigned>(level.parents);
    const std::size_t share = items / parents + 1;
    const dim3 blocks{std::max(1u, std::min(geometry.blocks(share), 4 * geometry.resident / parents)), parents};
    const Launch launch{stream, blocks, geometry.threads, sizeof(MembersShared)};
    if (!reaching.frames.reach) {
        launch(members_kernel<false, StaticTriangle>, level, balls, listed, members, reaching, StaticTriangle{}, total,
               unplaced);
        return;
    }
    with_primitive(reaching.primitives, [&](auto primitive) {
        launch(members_kernel<true, decltype(primitive)>, level, balls, listed, members, reaching, primitive, total,
               unplaced);
    });
}

void make_places(cudaStream_t stream, const Level& level, unsigned long long capacity, unsigned long long* wanted) {
    constexpr int threads = 256;
    Launch{stream, 1, threads, sizeof(PlacesShared<threads>)}(places_kernel<threads>, level, capacity, wanted);
}

}  // namespace crumple::cuda
