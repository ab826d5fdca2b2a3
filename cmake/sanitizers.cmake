if(CRUMPLE_SANITIZE)
    add_compile_options(-fsanitize=${CRUMPLE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
    add_link_options(-fsanitize=${CRUMPLE_SANITIZE})
endif()
