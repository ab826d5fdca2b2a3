# CUDA sources compiled as C++ and run by the CPU (README.md).

# cuda_on_cpu_sources(TARGET SOURCES...): adds .cu and .cpp files to a target; <cuda_runtime.h> and <cub/...> are
# the shim's.
function(cuda_on_cpu_sources target)
    set_source_files_properties(${ARGN} PROPERTIES LANGUAGE CXX)
    target_sources(${target} PRIVATE ${ARGN})
    target_link_libraries(${target} PUBLIC cuda_on_cpu)
    # As nvcc's --fmad=false.
    target_compile_options(${target} PRIVATE -ffp-contract=off -Wno-unknown-pragmas)
endfunction()

# cuda_on_cpu_library(NAME SOURCES ... [LIBRARIES ...]): a static library of them.
function(cuda_on_cpu_library name)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;LIBRARIES")
    add_library(${name} STATIC)
    cuda_on_cpu_sources(${name} ${arg_SOURCES})
    target_link_libraries(${name} PUBLIC ${arg_LIBRARIES})
endfunction()
