#include "engine/cuda/host_mesh.h"

#include <algorithm>

#include "engine/cuda/memory.h"

namespace crumple::cuda {
namespace {

// Copies the bytes from the first to the last value of `view`, and makes it one of the copy.
template <class Type>
void bring_rows(ArrayView<Type>& view, std::size_t value_bytes, cudaStream_t stream, std::vector<std::byte>& copy) {
    if (view.rows == 0) return;
    const std::int64_t last_row = (view.rows - 1) * view.row_stride, last_column = 2 * view.column_stride;
    const std::int64_t begin = std::min<std::int64_t>(0, last_row) + std::min<std::int64_t>(0, last_column);
    const std::int64_t end = std::max<std::int64_t>(0, last_row) + std::max<std::int64_t>(0, last_column);
    copy.resize(static_cast<std::size_t>(end - begin) + value_bytes);
    copy_now(stream, copy.data(), static_cast<const std::byte*>(view.data) + begin, copy.size(),
             cudaMemcpyDeviceToHost);
    view.data = copy.data() - begin;
}

}  // namespace

HostMesh::HostMesh(const MeshView& device, cudaStream_t stream) : groups_(device.groups.size()), view_(device) {
    bring_rows(view_.vertices, device.vertices.type == ScalarType::float32 ? 4 : 8, stream, vertices_);
    bring_rows(view_.triangles, device.triangles.type == IndexType::int64 ? 8 : 4, stream, triangles_);
    if (!groups_.empty())
        copy_now(stream, groups_.data(), device.groups.data(), groups_.size(), cudaMemcpyDeviceToHost);
    view_.groups = groups_;
    view_.memory = MemorySpace::host;
}

}  // namespace crumple::cuda
