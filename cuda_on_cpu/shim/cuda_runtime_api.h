#pragma once

// CUDA's runtime API on the CPU. See cuda_on_cpu/README.md.

#include "cuda_on_cpu/shim/cuda_on_cpu/runtime_api.h"
