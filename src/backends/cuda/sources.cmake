# The cuda backend's sources, for nvcc and, in the tests, for the CPU.
set(crumple_cuda_sources
    cuda_backend.cu comparison_cases.cu
    engine/finder.cu engine/finder_chunks.cu engine/launches.cu
    device/captures.cu device/cuda_device.cu device/gather.cu device/places.cu device/runtime.cu
    input/host_shape.cu input/device_input.cu input/cached_mesh.cu input/posed_worlds.cu input/world_names.cu
    input/worlds_side_by_side.cu
    stages/align.cu stages/bounds.cu stages/batched_clear.cu stages/output.cu stages/pass.cu stages/sort.cu stages/subdivide.cu
    intersections/result_on_device.cu intersections/intersection_chunks.cu intersections/device_contacts.cu
    intersections/find_any.cu intersections/intersection_finder.cu intersections/posed_world_calls.cu
    intersections/intersection_narrow.cu intersections/intersection_pass.cu intersections/intersection_stages.cu
    features/device_feature_queries.cu features/feature_finder.cu features/feature_input.cu features/feature_narrow.cu
    features/feature_rows.cu features/feature_pass.cu features/feature_stages.cu features/row_finder.cu
    overlaps/crossing_terms.cu overlaps/device_overlaps.cu
    candidates/candidate_finder.cu candidates/candidate_narrow.cu)
list(TRANSFORM crumple_cuda_sources PREPEND ${CMAKE_CURRENT_LIST_DIR}/)
