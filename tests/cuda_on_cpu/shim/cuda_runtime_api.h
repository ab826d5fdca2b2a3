#pragma once

// CUDA's runtime API, done by the CPU. See docs/cuda_on_cpu.md.

#include "cuda_on_cpu/shim/cuda_on_cpu/runtime_api.h"
