#pragma once

// The kernels of overlaps of an instruction set, or null for the plain one, which has none.

#include "backends/overlap_kernels.h"
#include "crumple/options.h"

namespace crumple::cpu {

const OverlapKernels* overlap_kernels(Simd simd);

}  // namespace crumple::cpu
