#include "backends/cuda/input/host_shape.h"

#include <algorithm>

#include "backends/cuda/device/memory.h"
#include "scene/outline.h"

namespace crumple::cuda {
namespace {

// Downloads the bytes from the first to the last value of `view`, and makes `view` refer to the copy.
template <class Type>
void download_rows(ArrayView<Type>& view, std::size_t value_bytes, cudaStream_t stream, std::vector<std::byte>& copy) {
    if (view.rows <= 0 || fault_of(view)) return;  // an invalid view stays unchanged; the host reports it
    const std::int64_t last_row = (view.rows - 1) * view.row_stride, last_column = 2 * view.column_stride;
    const std::int64_t begin = std::min<std::int64_t>(0, last_row) + std::min<std::int64_t>(0, last_column);
    const std::int64_t end = std::max<std::int64_t>(0, last_row) + std::max<std::int64_t>(0, last_column);
    copy.resize(static_cast<std::size_t>(end - begin) + value_bytes);
    copy_now(stream, copy.data(), static_cast<const std::byte*>(view.data) + begin, copy.size(),
             cudaMemcpyDeviceToHost);
    view.data = copy.data() - begin;
}
void download_rows(VertexView& view, cudaStream_t stream, std::vector<std::byte>& copy) {
    download_rows(view, view.type == ScalarType::float32 ? 4 : 8, stream, copy);
}

template <class T>
void download(std::span<const T>& view, cudaStream_t stream, std::vector<T>& copy) {
    copy.resize(view.size());
    copy_now(stream, copy.data(), view.data(), view.size(), cudaMemcpyDeviceToHost);
    view = copy;
}

}  // namespace

void copy_to_host(const Shape& device, Copied what, cudaStream_t stream, HostShape& host) {
    host.shape = device;
    Shape& shape = host.shape;
    download_rows(shape.triangles, shape.triangles.type == IndexType::int64 ? 8 : 4, stream, host.triangles);
    if (shape.edges) download(*shape.edges, stream, host.edges);
    if (shape.points) download(*shape.points, stream, host.points);
    if (what == Copied::topology) {
        host.vertices.assign(3 * sizeof(double), {});
        shape.vertices = {host.vertices.data(), shape.vertices.rows, 0, 0, shape.vertices.type};
        shape.end = shape.rest = {};
        shape.groups = {};
        shape.radii = {};
        return;
    }
    download_rows(shape.vertices, stream, host.vertices);
    download_rows(shape.end, stream, host.end);
    download_rows(shape.rest, stream, host.rest);
    download(shape.groups, stream, host.groups);
    download(shape.radii, stream, host.radii);
}

}  // namespace crumple::cuda
