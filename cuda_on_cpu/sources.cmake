# Functions for CUDA sources that are compiled as C++ and run on the CPU (README.md).

# Compiler options with which the emulator counts the steps of kernels (machine/counts.h). If loops were vectorised or
# unrolled, the numbers of steps would depend on the CPU.
set(cuda_on_cpu_count_steps -fsanitize-coverage=trace-pc -fno-tree-vectorize -fno-unroll-loops CACHE INTERNAL "")

# cuda_on_cpu_sources(TARGET SOURCES...): adds .cu and .cpp files to a target, for which <cuda_runtime.h> and <cub/...>
# come from shim/.
function(cuda_on_cpu_sources target)
    set_source_files_properties(${ARGN} PROPERTIES LANGUAGE CXX)
    target_sources(${target} PRIVATE ${ARGN})
    target_link_libraries(${target} PUBLIC cuda_on_cpu)
    # Like --fmad=false of nvcc.
    target_compile_options(${target} PRIVATE -ffp-contract=off -Wno-unknown-pragmas)
    if(CUDA_ON_CPU_STEPS)
        target_compile_options(${target} PRIVATE ${cuda_on_cpu_count_steps})
    endif()
endfunction()

# cuda_on_cpu_library(NAME SOURCES ... [LIBRARIES ...]): adds a static library of such sources.
function(cuda_on_cpu_library name)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;LIBRARIES")
    add_library(${name} STATIC)
    cuda_on_cpu_sources(${name} ${arg_SOURCES})
    target_link_libraries(${name} PUBLIC ${arg_LIBRARIES})
endfunction()
