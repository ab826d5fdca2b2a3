if(CRUMPLE_SANITIZE)
    add_compile_options(-fsanitize=${CRUMPLE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
    if(CRUMPLE_SANITIZE MATCHES "undefined")
        # AddressSanitizer sees most of the same, and they are a quarter of the time to compile.
        add_compile_options(-fno-sanitize=null,object-size,vptr)
    endif()
    add_link_options(-fsanitize=${CRUMPLE_SANITIZE})
endif()
if(CRUMPLE_FUZZ)
    if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
        message(FATAL_ERROR "CRUMPLE_FUZZ needs clang: its targets are libFuzzer's")
    endif()
    add_compile_options(-fsanitize=fuzzer-no-link)  # all of the library tells which of its branches an input takes
endif()
