// Source through which nvcc compiles the planted kernels.
#include "cuda_on_cpu/tests/planted/kernels.cuh"
