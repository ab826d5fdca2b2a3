// Only so that nvcc compiles the kernels.
#include "cuda_on_cpu/tests/planted/kernels.cuh"
