# The cuda backend's sources, for nvcc and, in the tests, for the CPU.
set(crumple_cuda_sources
    align.cu answer.cu backend.cu bounds.cu candidate_finder.cu captures.cu chunks.cu clearing.cu contacts.cu device.cu feature_calls.cu feature_finder.cu flags.cu gather.cu host_shape.cu input.cu known_answers.cu known_mesh.cu output.cu pass.cu places.cu posed_worlds.cu runtime.cu search.cu sort.cu subdivide.cu world_finder.cu world_names.cu worlds.cu
    ../../questions/candidates/cuda/narrow.cu ../../questions/features/cuda/input.cu ../../questions/features/cuda/narrow.cu ../../questions/features/cuda/output.cu
    ../../questions/features/cuda/pass.cu ../../questions/features/cuda/stages.cu ../../questions/intersect/cuda/narrow.cu ../../questions/intersect/cuda/pass.cu ../../questions/intersect/cuda/stages.cu)
list(TRANSFORM crumple_cuda_sources PREPEND ${CMAKE_CURRENT_LIST_DIR}/)
