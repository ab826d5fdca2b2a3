if(CRUMPLE_SANITIZE)
    add_compile_options(-fsanitize=${CRUMPLE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
    if(CRUMPLE_SANITIZE MATCHES "undefined")
        # Leaves out checks that take a third of the time to compile: AddressSanitizer finds most of the same errors.
        # Fuzz targets keep pointer-overflow.
        add_compile_options(-fno-sanitize=null,object-size,vptr)
        if(NOT CRUMPLE_FUZZ)
            add_compile_options(-fno-sanitize=pointer-overflow)
        endif()
    endif()
    add_link_options(-fsanitize=${CRUMPLE_SANITIZE})
    find_program(CRUMPLE_LLD ld.lld)
    mark_as_advanced(CRUMPLE_LLD)
    if(CRUMPLE_LLD)
        add_link_options(-fuse-ld=lld)  # links in a third of the time
    endif()
endif()
if(CRUMPLE_FUZZ)
    if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
        message(FATAL_ERROR "CRUMPLE_FUZZ needs clang: its targets are libFuzzer's")
    endif()
    add_compile_options(-fsanitize=fuzzer-no-link)  # the whole library reports which of its branches an input takes
endif()
