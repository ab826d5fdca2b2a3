#include "engine/cuda/places.h"

#include <string>

#include "crumple/error.h"
#include "engine/cuda/runtime.h"

namespace crumple::cuda {
namespace {

/// Where an array lies that the device cannot read, or nothing.
std::string wrong_place(const void* array, int device) {
    cudaPointerAttributes attributes{};
    const cudaError_t error = cudaPointerGetAttributes(&attributes, array);
    if (error == cudaErrorInvalidValue) {  // CUDA's word for memory of the host, before 11
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
    int reads_all = 0;  // devices that page the host's memory in
    check(cudaDeviceGetAttribute(&reads_all, cudaDevAttrPageableMemoryAccess, device), "cudaDeviceGetAttribute");
    return reads_all ? "" : "in host memory";
}

}  // namespace

void Places::check(const void*& known, const void* array, const char* name, const std::string& which) {
    if (array == known) return;
    known = nullptr;
    if (const std::string where = wrong_place(array, device_); !where.empty()) {
        std::string text = name;
        text.append(which).append(" lie ").append(where).append(", which CUDA device ");
        text.append(std::to_string(device_)).append(" cannot read");
        throw Error(ErrorCode::invalid_argument, text);
    }
    known = array;
}

void Places::check(const char* name, const void* array) { check(known_[6], array, name, ""); }

void Places::check(const MeshView& a, const MeshView* b) {
    const std::array<const MeshView*, 2> meshes{&a, b};
    for (std::size_t side = 0; side < (b ? 2u : 1u); ++side) {
        const MeshView& mesh = *meshes[side];
        const std::string which = !b ? "" : side == 0 ? " of the first mesh" : " of the second mesh";
        const auto look = [&](std::size_t place, const char* name, const void* array, bool empty) {
            if (!empty) check(known_[3 * side + place], array, name, which);
        };
        look(0, "vertices", mesh.vertices.data, mesh.vertices.rows == 0);
        look(1, "triangles", mesh.triangles.data, mesh.triangles.rows == 0);
        look(2, "groups", mesh.groups.data(), mesh.groups.empty());
    }
}

}  // namespace crumple::cuda
