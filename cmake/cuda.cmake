# Enables CUDA for the cuda backend and its tests. The top level includes this, because a language is enabled for all
# folders at once.
if(NOT DEFINED CMAKE_CUDA_ARCHITECTURES)
    set(CMAKE_CUDA_ARCHITECTURES all-major)  # machine code for each generation, PTX for later ones
endif()
enable_language(CUDA)
if(CMAKE_CUDA_COMPILER_ID STREQUAL "NVIDIA" AND CMAKE_CUDA_COMPILER_VERSION VERSION_GREATER_EQUAL 13.0
   AND CMAKE_CUDA_COMPILER_VERSION VERSION_LESS 13.1)
    message(STATUS "nvcc ${CMAKE_CUDA_COMPILER_VERSION} miscompiles copies of small lists, which this source avoids; releases are "
        "built by nvcc 13.1 or later (docs/nvcc_13_0.md)")
endif()
# CMake before 3.31 expects this library, which CUDA 13 no longer has.
if(CMAKE_VERSION VERSION_LESS 3.31 AND CMAKE_CUDA_COMPILER_VERSION VERSION_GREATER_EQUAL 13)
    add_library(CUDA::nvToolsExt INTERFACE IMPORTED)
endif()
find_package(CUDAToolkit REQUIRED)
set(CMAKE_CUDA_STANDARD_REQUIRED OFF)

# Sets the standard by a flag, because CMake 3.25 turns 20 into 17 for nvcc 13. Forbids fused operations: signs and
# error bounds are proven without them, and host and device must produce the same bytes.
set(crumple_cuda_flags $<$<COMPILE_LANGUAGE:CUDA>:-std=c++20 --fmad=false --expt-relaxed-constexpr -Xcompiler=-ffp-contract=off>)
