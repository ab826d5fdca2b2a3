# Functions for CUDA sources that are compiled as C++ and run on the CPU (README.md).

# cuda_on_cpu_sources(TARGET SOURCES...): adds .cu and .cpp files to a target, for which <cuda_runtime.h> and <cub/...>
# come from shim/.
function(cuda_on_cpu_sources target)
    set_source_files_properties(${ARGN} PROPERTIES LANGUAGE CXX)
    target_sources(${target} PRIVATE ${ARGN})
    target_link_libraries(${target} PUBLIC cuda_on_cpu)
    # Like --fmad=false of nvcc.
    target_compile_options(${target} PRIVATE -ffp-contract=off -Wno-unknown-pragmas)
endfunction()

# cuda_on_cpu_library(NAME SOURCES ... [LIBRARIES ...]): adds a static library of such sources.
function(cuda_on_cpu_library name)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;LIBRARIES")
    add_library(${name} STATIC)
    cuda_on_cpu_sources(${name} ${arg_SOURCES})
    target_link_libraries(${name} PUBLIC ${arg_LIBRARIES})
endfunction()
