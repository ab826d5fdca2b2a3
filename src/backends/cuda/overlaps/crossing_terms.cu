#include "backends/cuda/overlaps/crossing_terms.h"

#include "exact/overlap/filtered_crossing.h"

namespace crumple::cuda {
namespace {

__global__ void crossing_kernel(CrossingArrays in) {
    for (std::size_t i = grid_thread(); i < in.pair_count; i += grid_stride()) {
        const RowArrays& row = in.rows[segment_of(i, in.first_pairs, in.row_count)];
        const CrossedFace a(row.surface[0].face(in.pairs[i].a)), b(row.surface[1].face(in.pairs[i].b));
        FilteredCrossingSigns signs(a, b);
        in.crossings[i] = PackedCrossings::pack(crumple::decide_crossings(signs));
    }
}

/// Adds the terms of the segments of a pair. Returns false, and adds nothing, if they are too uncertain.
__device__ bool add_pair(const DecidedCrossings& both, const RowArrays& row, const Pair& pair, bool numbers,
                         SegmentTerms& sum) {
    const FaceCorners a = row.surface[0].face(pair.a), b = row.surface[1].face(pair.b);
    const bool curves = numbers && row.curves != 0;
    SegmentTerms terms;
    for (const Shift shift : {Shift::forward, Shift::backward}) {
        const bool forward = shift == Shift::forward;
        const DecidedCrossing& crossing = forward ? both.forward : both.backward;
        if (!crossing.jumps.segment || (!forward && !(both.tied && curves))) continue;
        Segment segment = crossing.segment;
        segment.in_volume = forward;
        segment.times = static_cast<std::int8_t>(times_in_curves(both.tied));
        if (!add_if_certain(segment, a, b, row.origin, curves, terms)) return false;
    }
    sum.volume.add(terms.volume);
    sum.curves.add(terms.curves);
    return true;
}

/// Adds the sums of all lanes to that of the first one.
__device__ void add_lanes(Enclosed& sum) {
    for (unsigned away = 16; away > 0; away /= 2) {
        const DoubleWord value{__shfl_down_sync(whole_warp, sum.value.high, away),
                               __shfl_down_sync(whole_warp, sum.value.low, away)};
        sum = sum + Enclosed(value, __shfl_down_sync(whole_warp, sum.error, away));
    }
}
__device__ void add_lanes(Vec3<Enclosed>& sum) { add_lanes(sum.x), add_lanes(sum.y), add_lanes(sum.z); }

__global__ void segments_kernel(CrossingArrays in, bool numbers) {
    for (std::size_t chunk = grid_thread() / 32; chunk < in.chunk_count; chunk += grid_stride() / 32) {
        const PairChunk range = in.chunks[chunk];
        SegmentTerms sum;
        for (unsigned long long i = range.begin + threadIdx.x % 32; i < range.end; i += 32) {
            const DecidedCrossings both = in.crossings[i].unpack();
            if (!add_pair(both, in.rows[range.row], in.pairs[i], numbers, sum)) in.crossings[i].set_uncertain();
        }
        add_lanes(sum.volume.volume);
        add_lanes(sum.volume.moment);
        add_lanes(sum.curves.area);
        add_lanes(sum.curves.torque);
        if (threadIdx.x % 32 == 0) in.sums[chunk] = sum;
    }
}

__global__ void faces_kernel(SurfaceArrays surface, const CountedFace* faces, std::size_t count, Vec3d origin,
                             VolumeTerms<Enclosed>* sums) {
    const std::size_t chunks = (count + faces_per_sum - 1) / faces_per_sum;
    for (std::size_t chunk = grid_thread() / 32; chunk < chunks; chunk += grid_stride() / 32) {
        const std::size_t begin = chunk * faces_per_sum, end = min(count, begin + faces_per_sum);
        VolumeTerms<Enclosed> sum;
        for (std::size_t i = begin + threadIdx.x % 32; i < end; i += 32)
            add_face_terms(surface.face(faces[i].face), faces[i].times, origin, sum);
        add_lanes(sum.volume);
        add_lanes(sum.moment);
        if (threadIdx.x % 32 == 0) sums[chunk] = sum;
    }
}

}  // namespace

void decide_crossings(const Geometry& geometry, cudaStream_t stream, const CrossingArrays& arrays) {
    Launch{stream, geometry.blocks(arrays.pair_count), geometry.threads}(crossing_kernel, arrays);
}

void sum_segments(const Geometry& geometry, cudaStream_t stream, const CrossingArrays& arrays, bool numbers) {
    Launch{stream, geometry.blocks(32 * arrays.chunk_count), geometry.threads}(segments_kernel, arrays, numbers);
}

void sum_faces(const Geometry& geometry, cudaStream_t stream, const SurfaceArrays& surface, const CountedFace* faces,
               std::size_t count, const Vec3d& origin, VolumeTerms<Enclosed>* sums) {
    const std::size_t chunks = (count + faces_per_sum - 1) / faces_per_sum;
    Launch{stream, geometry.blocks(32 * chunks), geometry.threads}(faces_kernel, surface, faces, count, origin, sums);
}

void reserve_crossing_stack(const Geometry& geometry, cudaStream_t stream) {
    Launch{stream, 1, geometry.threads}(crossing_kernel, CrossingArrays{});
}

}  // namespace crumple::cuda
