#include "backends/cuda/device/places.h"

#include <string>

#include "backends/cuda/device/runtime.h"
#include "crumple/error.h"

namespace crumple::cuda {
namespace {

/// Returns a description of where the array lies if the device cannot read it, else an empty string.
std::string wrong_place(const void* array, int device) {
    cudaPointerAttributes attributes{};
    const cudaError_t error = cudaPointerGetAttributes(&attributes, array);
    if (error == cudaErrorInvalidValue) {  // reported for host memory before CUDA 11
        cudaGetLastError();
        attributes.type = cudaMemoryTypeUnregistered;
    } else {
        check(error, "cudaPointerGetAttributes");
    }
    switch (attributes.type) {
        case cudaMemoryTypeDevice:
            return attributes.device == device ? ""
                                               : "in the memory of CUDA device " + std::to_string(attributes.device);
        case cudaMemoryTypeManaged:
            return "";
        case cudaMemoryTypeHost:
            return attributes.devicePointer ? "" : "in host memory";
        default:
            break;
    }
    int reads_all = 0;  // some devices can read pageable host memory
    check(cudaDeviceGetAttribute(&reads_all, cudaDevAttrPageableMemoryAccess, device), "cudaDeviceGetAttribute");
    return reads_all ? "" : "in host memory";
}

}  // namespace

void ReadableArrays::look(Known& known, const char* name, const char* which, const void* array, bool empty) const {
    if (empty || array == known.array) return;
    known = {};
    if (const std::string where = wrong_place(array, device_); !where.empty()) {
        std::string text = name;
        text.append(which).append(" lie ").append(where).append(", which CUDA device ");
        text.append(std::to_string(device_)).append(" cannot read");
        throw Error(ErrorCode::invalid_argument, text);
    }
    known = {array};
}

void ReadableArrays::check(const char* name, const void* array) { look(known_[8], name, "", array, false); }

void ReadableArrays::check(const MeshView& a, const MeshView* b) {
    const std::array<const MeshView*, 2> meshes{&a, b};
    for (std::size_t side = 0; side < (b ? 2u : 1u); ++side) {
        const MeshView& mesh = *meshes[side];
        const char* which = !b ? "" : side == 0 ? " of the first mesh" : " of the second mesh";
        look(known_[3 * side], "vertices", which, mesh.vertices.data, mesh.vertices.rows == 0);
        look(known_[3 * side + 1], "triangles", which, mesh.triangles.data, mesh.triangles.rows == 0);
        look(known_[3 * side + 2], "groups", which, mesh.groups.data(), mesh.groups.empty());
    }
}

void ReadableArrays::check(const Shape& shape) {
    check(MeshView(shape.vertices, shape.triangles, shape.groups), nullptr);
    look(known_[3], "vertices at the end", "", shape.end.data, shape.end.rows == 0);
    look(known_[4], "rest vertices", "", shape.rest.data, shape.rest.rows == 0);
    look(known_[5], "radii", "", shape.radii.data(), shape.radii.empty());
    if (shape.edges) look(known_[6], "edges", "", shape.edges->data(), shape.edges->empty());
    if (shape.points) look(known_[7], "points", "", shape.points->data(), shape.points->empty());
}

}  // namespace crumple::cuda
