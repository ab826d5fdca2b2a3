#pragma once

// Copies of host meshes and arrays in device memory, as simulations on a device have them.

#include <cuda_runtime.h>

#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "crumple/crumple.h"

namespace crumple::test {

inline void check(cudaError_t error) {
    if (error != cudaSuccess) throw std::runtime_error(cudaGetErrorString(error));
}

/// Owner of bytes in device memory.
class DeviceBytes {
   public:
    DeviceBytes() = default;
    explicit DeviceBytes(const std::vector<std::byte>& bytes) : size_(bytes.size()) {
        check(cudaMalloc(&data_, size_ + 1));
        set(bytes);
    }
    DeviceBytes(DeviceBytes&& other) noexcept : data_(other.data_), size_(other.size_) { other.data_ = nullptr; }
    DeviceBytes& operator=(DeviceBytes&& other) noexcept {
        std::swap(data_, other.data_);
        std::swap(size_, other.size_);
        return *this;
    }
    ~DeviceBytes() { cudaFree(data_); }
    void set(const std::vector<std::byte>& bytes) {
        if (!bytes.empty()) check(cudaMemcpy(data_, bytes.data(), bytes.size(), cudaMemcpyHostToDevice));
        check(cudaDeviceSynchronize());  // the copy may return before its end, and not all streams wait for it
    }
    void* data() const { return data_; }

   private:
    void* data_ = nullptr;
    std::size_t size_ = 0;
};

/// Copy of a host mesh with the same numbers, in rows without gaps.
class DeviceMesh {
   public:
    explicit DeviceMesh(const MeshView& host)
        : vertices_(rows(host.vertices, host.vertices.type == ScalarType::float32 ? 4 : 8)),
          triangles_(rows(host.triangles, host.triangles.type == IndexType::int64 ? 8 : 4)),
          groups_(bytes(host.groups)),
          view_(host) {
        const auto pack = [](auto& view, const DeviceBytes& memory, std::int64_t size) {
            view.data = memory.data();
            view.column_stride = size;
            view.row_stride = 3 * size;
        };
        pack(view_.vertices, vertices_, host.vertices.type == ScalarType::float32 ? 4 : 8);
        pack(view_.triangles, triangles_, host.triangles.type == IndexType::int64 ? 8 : 4);
        if (!host.groups.empty()) view_.groups = {static_cast<const std::int32_t*>(groups_.data()), host.groups.size()};
        view_.memory = MemorySpace::cuda;
    }
    const MeshView& view() const { return view_; }
    /// Replaces the vertices; their number must not change.
    void set_vertices(const MeshView& host) {
        vertices_.set(rows(host.vertices, host.vertices.type == ScalarType::float32 ? 4 : 8));
    }

   private:
    template <class Type>
    static std::vector<std::byte> rows(const ArrayView<Type>& view, std::int64_t size) {
        std::vector<std::byte> out(static_cast<std::size_t>(3 * view.rows * size));
        for (std::int64_t i = 0; i < 3 * view.rows; ++i)
            std::memcpy(out.data() + i * size,
                        static_cast<const std::byte*>(view.data) + i / 3 * view.row_stride + i % 3 * view.column_stride,
                        static_cast<std::size_t>(size));
        return out;
    }
    static std::vector<std::byte> bytes(std::span<const std::int32_t> values) {
        std::vector<std::byte> out(values.size_bytes());
        if (!out.empty()) std::memcpy(out.data(), values.data(), out.size());
        return out;
    }
    DeviceBytes vertices_, triangles_, groups_;
    MeshView view_;
};

/// Downloads an array.
template <class T>
std::vector<T> to_host(const T* device, std::int64_t n) {
    std::vector<T> host(static_cast<std::size_t>(n));
    if (n > 0) check(cudaMemcpy(host.data(), device, host.size() * sizeof(T), cudaMemcpyDeviceToHost));
    return host;
}

}  // namespace crumple::test
