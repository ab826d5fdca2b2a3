#pragma once

// CUDA's runtime API and device functions on the CPU. See cuda_on_cpu/README.md.

// Like CUDA's own header, this one includes the host's mathematical functions.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "cuda_on_cpu/shim/cuda_on_cpu/arithmetic.h"
#include "cuda_on_cpu/shim/cuda_on_cpu/atomics.h"
#include "cuda_on_cpu/shim/cuda_on_cpu/bits.h"
#include "cuda_on_cpu/shim/cuda_on_cpu/launch.h"
#include "cuda_on_cpu/shim/cuda_on_cpu/runtime_api.h"
#include "cuda_on_cpu/shim/cuda_on_cpu/shared_memory.h"
#include "cuda_on_cpu/shim/cuda_on_cpu/synchronize.h"
#include "cuda_on_cpu/shim/cuda_on_cpu/thread_index.h"
#include "cuda_on_cpu/shim/cuda_on_cpu/warp.h"
// Last, because its macros replace words that other headers might use.
#include "cuda_on_cpu/shim/cuda_on_cpu/qualifiers.h"
