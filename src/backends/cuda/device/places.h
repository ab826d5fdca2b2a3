#pragma once

// Checks that the device can read the caller's arrays. A kernel that reads an invalid address makes all later CUDA
// calls of the process fail, so every address is checked before.

#include <array>
#include <string>

#include "crumple/mesh.h"
#include "crumple/world.h"

namespace crumple::cuda {

class ReadableArrays {
   public:
    explicit ReadableArrays(int device) : device_(device) {}

    /// Throws Error (invalid_argument) that names the first array that the device cannot read. The addresses of the
    /// previous call are cached, so a frame whose arrays have not moved costs no CUDA call.
    void check(const MeshView& a, const MeshView* b);
    /// Checks all arrays of a shape.
    void check(const Shape& shape);
    /// Checks one array, which the error calls `name`.
    void check(const char* name, const void* array);

   private:
    struct Known {
        const void* array = nullptr;
    };
    void look(Known& known, const char* name, const char* which, const void* array, bool empty) const;

    int device_;
    std::array<Known, 9> known_{};
};

}  // namespace crumple::cuda
