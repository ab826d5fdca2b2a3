#pragma once

// A mesh of the device, copied to the host.

#include <cstddef>
#include <vector>

#include "crumple/mesh.h"
#include "engine/cuda/runtime.h"

namespace crumple::cuda {

class HostMesh {
   public:
    /// Done when it returns. Rows keep their strides, so what lies between them comes along.
    HostMesh(const MeshView& device, cudaStream_t stream);
    HostMesh(const HostMesh&) = delete;
    const MeshView& view() const { return view_; }

   private:
    std::vector<std::byte> vertices_, triangles_;
    std::vector<std::int32_t> groups_;
    MeshView view_;
};

}  // namespace crumple::cuda
