#include "backends/cuda/stages/align.h"

#include <algorithm>

#include <cub/block/block_reduce.cuh>

#include "geometry/edge_moment.h"

namespace crumple::cuda {
namespace {

constexpr int threads = 256;  // per block; also the maximum number of members sampled per leaf

struct FrameShared {
    cub::BlockReduce<double, threads>::TempStorage sum;
    cub::BlockReduce<float, threads>::TempStorage most;
    double sums[6];
    PrincipalAxes axes;
    BinnedFrame frame;
};

// Returns the sum of a value over the block's threads, to all of them; block_max() returns the maximum.
__device__ double block_sum(FrameShared& shared, double value, double& slot) {
    __syncthreads();
    const double sum = cub::BlockReduce<double, threads>(shared.sum).Sum(value);
    if (threadIdx.x == 0) slot = sum;
    __syncthreads();
    return slot;
}
struct Larger {
    __device__ float operator()(float a, float b) const { return a < b ? b : a; }
};
__device__ float block_max(FrameShared& shared, float value) {
    __syncthreads();
    const float most = cub::BlockReduce<float, threads>(shared.most).Reduce(value, Larger());
    if (threadIdx.x == 0) shared.sums[0] = most;
    __syncthreads();
    return static_cast<float>(shared.sums[0]);
}

// Frame of a leaf without members, or with coordinates that are not finite.
__device__ BinnedFrame plain_frame() {
    BinnedFrame frame;
    frame.origin = {0, 0, 0};
    frame.axis[0] = {1, 0, 0}, frame.axis[1] = {0, 1, 0}, frame.axis[2] = {0, 0, 1};
    frame.big = INFINITY;
    frame.base = -1;
    frame.scale = bins / 2;
    return frame;
}
__device__ bool is_finite(float x) { return std::abs(x) < INFINITY; }
__device__ bool is_finite(const Vec3f& v) { return is_finite(v.x) && is_finite(v.y) && is_finite(v.z); }
__device__ bool is_finite(const BinnedFrame& f) {
    return is_finite(f.origin) && is_finite(f.axis[0]) && is_finite(f.axis[1]) && is_finite(f.axis[2]) && f.big > 0 &&
           is_finite(f.base) && is_finite(f.scale);
}

// Replaces the frame's axes by the coordinate axes, first the one nearest to the frame's first axis.
__device__ void turn_to_coordinates(LeafFrame& frame) {
    const Vec3f along = abs(frame.axis[0]);
    const int first = along.x == largest(along) ? 0 : along.y == largest(along) ? 1 : 2;
    for (int i = 0; i < 3; ++i) {
        frame.axis[i] = {0, 0, 0};
        frame.axis[i][(first + i) % 3] = 1;
    }
}

// Computes the frame of one leaf. All threads of the block call it together.
__device__ void make_frame(FrameShared& shared, unsigned long long begin, unsigned long long members,
                           const std::int32_t* triangle, const PreparedScene& scene, const PointRows& points,
                           const Ball* balls, bool along_axes, BinnedFrame& result) {
    const auto samples = static_cast<unsigned>(members < threads ? members : threads);
    const bool has = threadIdx.x < samples;
    const std::int32_t sample = has ? triangle[begin + threadIdx.x * members / samples] : 0;
    const Ball ball = has ? balls[sample] : Ball{0, 0, 0, 0};
    const double share = has ? 1.0 / samples : 0.0;

    Vec3d mean;
    mean.x = block_sum(shared, share * ball.x, shared.sums[0]);
    mean.y = block_sum(shared, share * ball.y, shared.sums[0]);
    mean.z = block_sum(shared, share * ball.z, shared.sums[0]);
    const double radius = block_sum(shared, share * ball.r, shared.sums[0]);
    const Vec3d d = has ? Vec3d{ball.x, ball.y, ball.z} - mean : Vec3d{};
    SymmetricMatrix covariance;
    covariance.xx = block_sum(shared, share * d.x * d.x, shared.sums[0]);
    covariance.xy = block_sum(shared, share * d.x * d.y, shared.sums[1]);
    covariance.xz = block_sum(shared, share * d.x * d.z, shared.sums[2]);
    covariance.yy = block_sum(shared, share * d.y * d.y, shared.sums[3]);
    covariance.yz = block_sum(shared, share * d.y * d.z, shared.sums[4]);
    covariance.zz = block_sum(shared, share * d.z * d.z, shared.sums[5]);
    const float spread = block_max(shared, static_cast<float>(largest(abs(d))));

    PrincipalAxes& axes = shared.axes;
    if (threadIdx.x == 0) axes = principal_axes(covariance);
    __syncthreads();
    EdgeMoment moment;
    if (has) {
        const std::int32_t* corner = scene.corners + 3 * static_cast<std::size_t>(sample);
        moment.add_triangle(points[corner[0]], points[corner[1]], points[corner[2]], axes);
    }
    moment = {block_sum(shared, moment.re, shared.sums[0]), block_sum(shared, moment.im, shared.sums[1])};

    BinnedFrame& frame = shared.frame;
    if (threadIdx.x == 0) {
        turn_to_edges(axes, moment);
        frame.origin = to_float(mean);
        for (int i = 0; i < 3; ++i) frame.axis[i] = to_float(axes.axis[i]);
        if (along_axes) turn_to_coordinates(frame);
        frame.big = 2 * (spread + static_cast<float>(radius)) + 1e-30f;
    }
    __syncthreads();

    // The bins cover the range of the members that are not big along the sweep direction. The range need not be exact.
    float low = INFINITY, high = -INFINITY;
    for (unsigned long long m = begin + threadIdx.x; m < begin + members; m += threads) {
        const Ball b = balls[triangle[m]];
        if (ball_extent(b, frame.origin) > frame.big) continue;
        const float x = dot(frame.axis[0], Vec3f{b.x, b.y, b.z} - frame.origin);
        low = min(low, x - b.r);
        high = max(high, x + b.r);
    }
    high = block_max(shared, high);
    low = -block_max(shared, -low);
    if (threadIdx.x != 0) return;
    const bool any = high - low > 1e-30f;
    frame.base = any ? low : 0;
    frame.scale = any ? bins / (high - low) : 0;
    result = is_finite(frame) ? frame : plain_frame();
}

__global__ void frame_kernel(int leaves, Segments members_of, const std::int32_t* triangle, PreparedScene scene,
                             PointRows points, const Ball* balls, bool along_axes, BinnedFrame* frames) {
    auto& shared = dynamic_shared<FrameShared>();
    for (int leaf = static_cast<int>(blockIdx.x); leaf < leaves; leaf += static_cast<int>(gridDim.x)) {
        const auto l = static_cast<std::size_t>(leaf);
        const unsigned long long begin = members_of.first[l], members = members_of.end(l) - begin;
        if (members > 0)
            make_frame(shared, begin, members, triangle, scene, points, balls, along_axes, frames[l]);
        else if (threadIdx.x == 0)
            frames[l] = plain_frame();
    }
}

template <class Primitive>
__global__ void extent_kernel(int leaves, Segments members_of, Members members, PreparedScene scene,
                              Primitive primitive, PointRows points, const Ball* balls, Frames frames) {
    const auto n = static_cast<std::size_t>(leaves);
    for (unsigned long long m = grid_thread(); m < members_of.first[n]; m += grid_stride()) {
        const std::size_t leaf = segment_of(m, members_of.first, n);
        if (m >= members_of.end(leaf)) continue;
        const BinnedFrame& frame = frames.binned[leaf];
        const std::int32_t t = members.triangle[m];
        float reach = ball_extent(balls[t], frame.origin);
        if (reach > frame.big) reach = exact_extent(scene, primitive, points, t, frame, reach);
        atomicMax(&frames.reach[leaf], __float_as_uint(reach));
    }
}

}  // namespace

void make_frames(const Geometry& geometry, cudaStream_t stream, int leaves, const Segments& members_of,
                 const std::int32_t* triangle, const PreparedScene& scene, const Points& points, const Ball* balls,
                 bool along_axes, BinnedFrame* frames) {
    const unsigned blocks = std::min(static_cast<unsigned>(leaves), geometry.resident * geometry.threads / threads);
    Launch{stream, blocks, threads, sizeof(FrameShared)}(frame_kernel, leaves, members_of, triangle, scene,
                                                         points.rows(), balls, along_axes, frames);
}

void measure_extent(const Geometry& geometry, cudaStream_t stream, int leaves, const Segments& members_of,
                    const Members& members, const PreparedScene& scene, const Primitives& primitives,
                    const Points& points, const Ball* balls, const Frames& frames) {
    with_primitive(primitives, [&](auto primitive) {
        Launch{stream, geometry.blocks(members.capacity), geometry.threads}(extent_kernel<decltype(primitive)>, leaves,
                                                                            members_of, members, scene, primitive,
                                                                            points.rows(), balls, frames);
    });
}

}  // namespace crumple::cuda
