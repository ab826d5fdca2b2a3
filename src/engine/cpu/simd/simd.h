#pragma once

#include <vector>

#include "engine/cpu/kernels.h"

namespace crumple::cpu {

/// The best SIMD table for `simd` (automatic: any) that both build and machine have, or null.
const Kernels* simd_kernels(Simd simd);

/// Every SIMD table that both have, best first: for tests.
std::vector<const Kernels*> all_simd_kernels();

}  // namespace crumple::cpu
