#pragma once

// Where a caller's arrays lie: a kernel that reads an address the device does not know ends every later call of the
// process, so each is asked for before.

#include <array>
#include <string>

#include "crumple/mesh.h"
#include "crumple/world.h"

namespace crumple::cuda {

class Places {
   public:
    explicit Places(int device) : device_(device) {}

    /// Throws Error (invalid_argument) that names the first array that the device cannot read. Arrays of the call
    /// before are known, so that frames of a simulation ask for nothing.
    void check(const MeshView& a, const MeshView* b);
    /// Of all that a shape has.
    void check(const Shape& shape);
    /// The same for an array that is called `name`.
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
