# crumple_test_of_ranks(NAME TARGET RANKS): adds a test that runs the target by mpirun.
function(crumple_test_of_ranks name target ranks)
    add_test(NAME ${name} COMMAND ${MPIEXEC_EXECUTABLE} ${MPIEXEC_NUMPROC_FLAG} ${ranks} $<TARGET_FILE:${target}>)
    # These variables allow Open MPI to run as root, and with more ranks than cores, where waiting ranks yield. It
    # starts in half the time if it need not look for a network. It leaks at its end, which AddressSanitizer would
    # report.
    set_tests_properties(${name} PROPERTIES TIMEOUT 300 LABELS mpi ENVIRONMENT
        "OMPI_ALLOW_RUN_AS_ROOT=1;OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1;OMPI_MCA_rmaps_base_oversubscribe=1;OMPI_MCA_mpi_yield_when_idle=1;OMPI_MCA_hwloc_base_binding_policy=none;OMPI_MCA_btl_vader_single_copy_mechanism=none;OMPI_MCA_pml=ob1;LSAN_OPTIONS=detect_leaks=0")
endfunction()
