if(CRUMPLE_SANITIZE)
    add_compile_options(-fsanitize=${CRUMPLE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
    if(CRUMPLE_SANITIZE MATCHES "undefined")
        # AddressSanitizer sees most of the same, and they are a quarter of the time to compile.
        add_compile_options(-fno-sanitize=null,object-size,vptr)
    endif()
    add_link_options(-fsanitize=${CRUMPLE_SANITIZE})
endif()
