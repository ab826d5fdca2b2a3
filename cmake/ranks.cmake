# crumple_test_of_ranks(NAME TARGET RANKS): a test that runs the target by mpirun.
function(crumple_test_of_ranks name target ranks)
    add_test(NAME ${name} COMMAND ${MPIEXEC_EXECUTABLE} ${MPIEXEC_NUMPROC_FLAG} ${ranks} $<TARGET_FILE:${target}>)
    # Open MPI refuses root, and more ranks than cores, unless it is told to let them be; ranks that wait then yield. It
    # starts in half the time where it need not look for a network, and leaks at its end, which AddressSanitizer would tell.
    set_tests_properties(${name} PROPERTIES TIMEOUT 300 LABELS mpi ENVIRONMENT
        "OMPI_ALLOW_RUN_AS_ROOT=1;OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1;OMPI_MCA_rmaps_base_oversubscribe=1;OMPI_MCA_mpi_yield_when_idle=1;OMPI_MCA_hwloc_base_binding_policy=none;OMPI_MCA_btl_vader_single_copy_mechanism=none;OMPI_MCA_pml=ob1;LSAN_OPTIONS=detect_leaks=0")
endfunction()
