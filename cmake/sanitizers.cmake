if(CRUMPLE_SANITIZE)
    add_compile_options(-fsanitize=${CRUMPLE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
    if(CRUMPLE_SANITIZE MATCHES "undefined")
        # Leaves out checks that take a third of the time to compile: AddressSanitizer finds most of the same errors.
        # tests/fuzz/CMakeLists.txt adds pointer-overflow to the readers.
        add_compile_options(-fno-sanitize=null,object-size,vptr,pointer-overflow)
    endif()
    if(CRUMPLE_SANITIZE MATCHES "thread" AND CMAKE_CXX_COMPILER_ID MATCHES "Clang")
        # Does not record calls, which takes a third of the time of some tests, so stacks in reports have one function each.
        # Repeat a failed test without the option.
        add_compile_options("SHELL:-mllvm -tsan-instrument-func-entry-exit=0")
    endif()
    if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
        add_compile_options(-fsanitize-ignorelist=${CMAKE_CURRENT_LIST_DIR}/sanitizers.ignore)
    endif()
    add_link_options(-fsanitize=${CRUMPLE_SANITIZE})
    find_program(CRUMPLE_LLD ld.lld)
    mark_as_advanced(CRUMPLE_LLD)
    if(CRUMPLE_LLD)
        add_link_options(-fuse-ld=lld)  # links in a third of the time
    endif()
endif()
