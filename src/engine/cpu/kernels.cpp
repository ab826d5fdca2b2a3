#include "engine/cpu/kernels.h"

#include "crumple/error.h"
#include "engine/cpu/simd/simd.h"

namespace crumple::cpu {

const Kernels& kernels_for(Simd simd) {
    if (simd != Simd::scalar) {
        if (const Kernels* kernels = simd_kernels(simd)) return *kernels;
        if (simd != Simd::automatic)
            throw Error(ErrorCode::backend_unavailable,
                        "the instruction set asked for is not one that both this build and this machine have",
                        Element::option);
    }
    return scalar_kernels;
}

}  // namespace crumple::cpu
