// Devices, allocation, copies.

#include <cstring>
#include <numeric>

#include "cuda_on_cpu/tests/portable/portable.h"

namespace {

using portable::Array;
using portable::check;

class Memory : public portable::DeviceTest {};

TEST_F(Memory, devices_report_their_properties) {
    int device = -1, value = 0;
    EXPECT_EQ(cudaGetDevice(&device), cudaSuccess);
    EXPECT_EQ(device, 0);
    cudaDeviceProp properties;
    ASSERT_EQ(cudaGetDeviceProperties(&properties, device), cudaSuccess);
    EXPECT_EQ(properties.warpSize, 32);
    EXPECT_GT(std::strlen(properties.name), 0u);
    EXPECT_GE(properties.sharedMemPerBlockOptin, properties.sharedMemPerBlock);
    EXPECT_EQ(cudaDeviceGetAttribute(&value, cudaDevAttrMultiProcessorCount, device), cudaSuccess);
    EXPECT_EQ(value, properties.multiProcessorCount);
    EXPECT_EQ(cudaDeviceGetAttribute(&value, cudaDevAttrComputeCapabilityMajor, device), cudaSuccess);
    EXPECT_EQ(value, properties.major);
    std::size_t free = 0, total = 0;
    EXPECT_EQ(cudaMemGetInfo(&free, &total), cudaSuccess);
    EXPECT_LE(free, total);
    EXPECT_EQ(cudaSetDevice(1000), cudaErrorInvalidDevice);
    EXPECT_STREQ(cudaGetErrorName(cudaErrorInvalidDevice), "cudaErrorInvalidDevice");
    EXPECT_EQ(cudaPeekAtLastError(), cudaErrorInvalidDevice);
    EXPECT_EQ(cudaGetLastError(), cudaErrorInvalidDevice);
    EXPECT_EQ(cudaGetLastError(), cudaSuccess);
}

TEST_F(Memory, pointer_attributes_report_the_kind_of_memory) {
    const Array<int> device(4);
    int* pinned = nullptr;
    std::vector<int> pageable(1 << 16);
    check(cudaMallocHost(&pinned, 16));
    cudaPointerAttributes attributes;
    check(cudaPointerGetAttributes(&attributes, device.data() + 1));
    EXPECT_EQ(attributes.type, cudaMemoryTypeDevice);
    EXPECT_EQ(attributes.device, 0);
    EXPECT_EQ(attributes.devicePointer, device.data() + 1);
    check(cudaPointerGetAttributes(&attributes, pinned));
    EXPECT_EQ(attributes.type, cudaMemoryTypeHost);
    EXPECT_EQ(attributes.hostPointer, pinned);
    check(cudaPointerGetAttributes(&attributes, pageable.data()));
    EXPECT_EQ(attributes.type, cudaMemoryTypeUnregistered);
    check(cudaHostRegister(pageable.data(), pageable.size() * sizeof(int), cudaHostRegisterDefault));
    check(cudaPointerGetAttributes(&attributes, pageable.data() + 100));
    EXPECT_EQ(attributes.type, cudaMemoryTypeHost);
    check(cudaHostUnregister(pageable.data()));
    check(cudaFreeHost(pinned));
    void* managed = nullptr;
    check(cudaMallocManaged(&managed, 8));
    check(cudaPointerGetAttributes(&attributes, managed));
    EXPECT_EQ(attributes.type, cudaMemoryTypeManaged);
    check(cudaFree(managed));
}

TEST_F(Memory, allocations_are_aligned_and_empty_ones_are_null) {
    for (const std::size_t bytes : {1u, 3u, 255u, 256u, 4097u}) {
        const Array<char> memory(bytes);
        EXPECT_EQ(reinterpret_cast<std::uintptr_t>(memory.data()) % 256, 0u);
    }
    void* none = &none;
    EXPECT_EQ(cudaMalloc(&none, 0), cudaSuccess);
    EXPECT_EQ(none, nullptr);
    EXPECT_EQ(cudaFree(nullptr), cudaSuccess);
    EXPECT_EQ(cudaMalloc(&none, std::size_t{1} << 60), cudaErrorMemoryAllocation);
    EXPECT_EQ(cudaGetLastError(), cudaErrorMemoryAllocation);
}

TEST_F(Memory, copies_in_every_direction_keep_the_bytes) {
    std::vector<int> in(100), out(100);
    std::iota(in.begin(), in.end(), 0);
    const Array<int> a(100), b(100);
    check(cudaMemcpyAsync(a.data(), in.data(), 400, cudaMemcpyHostToDevice));
    in.assign(100, -1);  // pageable memory has been read when the call returns
    check(cudaMemcpyAsync(b.data(), a.data(), 400, cudaMemcpyDeviceToDevice));
    check(cudaMemsetAsync(b.data() + 10, 0, 40));
    check(cudaMemcpyAsync(out.data(), b.data(), 400, cudaMemcpyDefault));
    check(cudaDeviceSynchronize());
    for (int i = 0; i < 100; ++i) EXPECT_EQ(out[static_cast<std::size_t>(i)], i >= 10 && i < 20 ? 0 : i);
    std::vector<int> other(100);
    check(cudaMemcpy(other.data(), out.data(), 400, cudaMemcpyHostToHost));
    EXPECT_EQ(other, out);
}

TEST_F(Memory, strided_copies_skip_padding) {
    // Copies three of each four floats, as from vertices with padding.
    std::vector<float> vertices(40);
    std::iota(vertices.begin(), vertices.end(), 0.0f);
    const Array<float> packed(30);
    check(cudaMemcpy2D(packed.data(), 12, vertices.data(), 16, 12, 10, cudaMemcpyHostToDevice));
    const std::vector<float> found = packed.values();
    for (std::size_t i = 0; i < 30; ++i) EXPECT_EQ(found[i], static_cast<float>(i / 3 * 4 + i % 3));
    // Copies them back to rows with padding, which must keep its values: on the device, and on the host.
    const std::vector<float> unwritten(40, -1.0f);
    const Array<float> padded(unwritten);
    std::vector<float> on_host = unwritten;
    check(cudaMemcpy2D(padded.data(), 16, packed.data(), 12, 12, 10, cudaMemcpyDeviceToDevice));
    check(cudaMemcpy2D(on_host.data(), 16, packed.data(), 12, 12, 10, cudaMemcpyDeviceToHost));
    const std::vector<float> on_device = padded.values();
    for (std::size_t i = 0; i < 40; ++i) {
        EXPECT_EQ(on_device[i], i % 4 == 3 ? -1.0f : vertices[i]) << i;
        EXPECT_EQ(on_host[i], i % 4 == 3 ? -1.0f : vertices[i]) << i;
    }
    EXPECT_EQ(cudaMemcpy2D(packed.data(), 8, vertices.data(), 16, 12, 10, cudaMemcpyHostToDevice),
              cudaErrorInvalidPitchValue);
    EXPECT_EQ(cudaGetLastError(), cudaErrorInvalidPitchValue);
}

__global__ void add_one(int* data, int n) {
    for (int i = static_cast<int>(threadIdx.x); i < n; i += static_cast<int>(blockDim.x)) data[i] += 1;
}

TEST_F(Memory, memory_allocated_in_stream_order_is_usable_by_later_work) {
    cudaStream_t stream;
    check(cudaStreamCreate(&stream));
    cudaMemPool_t pool;
    check(cudaDeviceGetDefaultMemPool(&pool, 0));
    std::uint64_t threshold = ~0ull, found = 0;
    check(cudaMemPoolSetAttribute(pool, cudaMemPoolAttrReleaseThreshold, &threshold));
    check(cudaMemPoolGetAttribute(pool, cudaMemPoolAttrReleaseThreshold, &found));
    EXPECT_EQ(found, threshold);
    int *a = nullptr, *b = nullptr;
    check(cudaMallocAsync(&a, 400, stream));
    check(cudaMemsetAsync(a, 0, 400, stream));
    check(portable::try_launch(stream, add_one, 1, 32, 0, a, 100));
    check(cudaMallocFromPoolAsync(&b, 400, pool, stream));
    check(cudaMemcpyAsync(b, a, 400, cudaMemcpyDeviceToDevice, stream));
    check(cudaFreeAsync(a, stream));
    check(portable::try_launch(stream, add_one, 1, 32, 0, b, 100));
    std::vector<int> out(100);
    check(cudaMemcpyAsync(out.data(), b, 400, cudaMemcpyDeviceToHost, stream));
    check(cudaFreeAsync(b, stream));
    check(cudaStreamSynchronize(stream));
    EXPECT_EQ(out, std::vector<int>(100, 2));
    check(cudaMemPoolTrimTo(pool, 0));
    check(cudaStreamDestroy(stream));
}

}  // namespace
