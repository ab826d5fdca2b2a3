#pragma once

// Kernels of an instruction set for sums over overlaps; null for plain C++, which has none.

#include "backends/overlap_kernels.h"
#include "crumple/options.h"

namespace crumple::cpu {

const OverlapKernels* overlap_kernels(Simd simd);

}  // namespace crumple::cpu
