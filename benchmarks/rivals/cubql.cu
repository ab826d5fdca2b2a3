// crumple_cubql_benchmark SCENE...: all pairs of overlapping bounding boxes of a scene's triangles, by cuBQL's BVH
// (https://github.com/NVIDIA/cuBQL, Apache-2.0), with mesh and pairs on the device.
//
// cuBQL computes less than crumple: it compares boxes instead of triangles, in float32. It lists adjacent triangles,
// too. A call makes the boxes, builds the BVH and queries it with each box; the host's clock is read when the pairs are
// complete, as for `device_and_wait` of crumple_cuda_benchmark. The program prints one row of JSON per scene; its exit
// status is 1 if anything failed.

#include <cuda_runtime.h>

#define CUBQL_GPU_BUILDER_IMPLEMENTATION 1
#include "cuBQL/bvh.h"
// bvh.h comes first, because the other headers use its declarations without including it.
#include "cuBQL/builder/cuda.h"
#include "cuBQL/builder/cuda/radix.h"
#include "cuBQL/builder/cuda/rebinMortonBuilder.h"
#include "cuBQL/traversal/fixedBoxQuery.h"

#include <cstdint>
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <string>
#include <vector>

#include "device_array.h"
#include "workload.h"

namespace crumple::benchmark {
namespace {

constexpr int warm_up = 5, calls = 100, block = 128;

int blocks(int threads) { return (threads + block - 1) / block; }

__global__ void find_boxes(const float* vertices, const std::int32_t* triangles, int count, cuBQL::box3f* boxes) {
    const int triangle = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
    if (triangle >= count) return;
    cuBQL::box3f box;
    for (int k = 0; k < 3; ++k) {
        const float* p = vertices + 3 * static_cast<std::size_t>(triangles[3 * triangle + k]);
        if (k == 0) box.lower = box.upper = cuBQL::vec3f(p[0], p[1], p[2]);
        box.lower = cuBQL::vec3f(fminf(box.lower.x, p[0]), fminf(box.lower.y, p[1]), fminf(box.lower.z, p[2]));
        box.upper = cuBQL::vec3f(fmaxf(box.upper.x, p[0]), fmaxf(box.upper.y, p[1]), fmaxf(box.upper.z, p[2]));
    }
    boxes[triangle] = box;
}

__device__ bool overlap(const cuBQL::box3f& a, const cuBQL::box3f& b) {
    return a.lower.x <= b.upper.x && b.lower.x <= a.upper.x && a.lower.y <= b.upper.y && b.lower.y <= a.upper.y &&
           a.lower.z <= b.upper.z && b.lower.z <= a.upper.z;
}

/// Counts all pairs, and writes up to `capacity` of them.
__global__ void find_pairs(cuBQL::bvh3f bvh, const cuBQL::box3f* boxes, int count, unsigned* found, int2* pairs,
                           unsigned capacity) {
    const int triangle = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
    if (triangle >= count) return;
    const cuBQL::box3f box = boxes[triangle];
    const auto visit = [&](std::uint32_t other) {
        if (static_cast<int>(other) > triangle && overlap(box, boxes[other])) {
            const unsigned place = atomicAdd(found, 1u);
            if (place < capacity) pairs[place] = make_int2(triangle, static_cast<int>(other));
        }
        return CUBQL_CONTINUE_TRAVERSAL;
    };
    cuBQL::fixedBoxQuery::forEachPrim(visit, bvh, box);
}

template <class T>
T* allocate(std::size_t count) {
    void* data = nullptr;
    check(cudaMalloc(&data, count * sizeof(T)));
    return static_cast<T*>(data);
}

/// Arrays of one scene on the device. They are not freed: a process measures few scenes.
struct Boxes {
    const float* vertices;
    const std::int32_t* triangles;
    int count;
    cuBQL::box3f* boxes;
    unsigned* found;
    unsigned capacity = 0;
    int2* pairs = nullptr;
    cudaStream_t stream = nullptr;
    cuBQL::AsyncGpuMemoryResource memory{0};  // keeps its pool between calls

    /// Finds the pairs and returns their number. Sets `built` and `complete` to the milliseconds from the start of the
    /// call until the host has launched the build, and until the pairs are complete.
    unsigned call(double& built, double& complete) {
        cuBQL::bvh3f bvh;
        unsigned result = 0;
        const auto build = [&] {
            check(cudaMemsetAsync(found, 0, sizeof(unsigned), stream));
            find_boxes<<<blocks(count), block, 0, stream>>>(vertices, triangles, count, boxes);
            cuBQL::cuda::rebinRadixBuilder(bvh, boxes, static_cast<std::uint32_t>(count), cuBQL::BuildConfig(), stream,
                                           memory);
        };
        const auto query = [&] {
            find_pairs<<<blocks(count), block, 0, stream>>>(bvh, boxes, count, found, pairs, capacity);
            check(cudaMemcpyAsync(&result, found, sizeof(unsigned), cudaMemcpyDeviceToHost, stream));
            check(cudaStreamSynchronize(stream));
        };
        built = milliseconds_of(build);
        complete = built + milliseconds_of(query);
        check(cudaGetLastError());
        cuBQL::cuda::free(bvh, stream, memory);
        check(cudaStreamSynchronize(stream));
        return result;
    }
};

void measure(const std::string& scene) {
    const Workload workload = load(scene);
    const std::vector<float> xyz = coordinates<float>(workload.a);
    const DeviceArray vertices(xyz.data(), xyz.size() * sizeof(float));
    const DeviceArray triangles(workload.a.triangles.data(), workload.a.triangles.size() * sizeof(std::int32_t));
    const int count = static_cast<int>(workload.a.triangle_count());
    Boxes boxes{static_cast<const float*>(vertices.data()), static_cast<const std::int32_t*>(triangles.data()), count,
                allocate<cuBQL::box3f>(static_cast<std::size_t>(count)), allocate<unsigned>(1)};
    check(cudaStreamCreateWithFlags(&boxes.stream, cudaStreamNonBlocking));
    double built = 0, complete = 0;
    boxes.capacity = boxes.call(built, complete);
    boxes.pairs = allocate<int2>(boxes.capacity + std::size_t{1});
    std::vector<double> builds, calls_complete;
    for (int i = -warm_up; i < calls; ++i) {
        if (boxes.call(built, complete) != boxes.capacity) throw std::runtime_error("the number of pairs varies");
        if (i < 0) continue;
        builds.push_back(built);
        calls_complete.push_back(complete);
    }
    const Summary build = summarise(builds), whole = summarise(calls_complete);
    std::printf(
        "{\"scene\": \"%s\", \"name\": \"cuBQL, boxes only\", \"triangles\": %d, \"pairs\": %u, \"median\": %.4f, "
        "\"lower_quartile\": %.4f, \"upper_quartile\": %.4f, \"launches_of_build\": %.4f}\n",
        scene.c_str(), count, boxes.capacity, whole.median, whole.lower_quartile, whole.upper_quartile, build.median);
}

}  // namespace
}  // namespace crumple::benchmark

int main(int argc, char** argv) {
    try {
        for (int i = 1; i < argc; ++i) crumple::benchmark::measure(argv[i]);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "crumple_cubql_benchmark: %s\n", error.what());
        return 1;
    }
}
