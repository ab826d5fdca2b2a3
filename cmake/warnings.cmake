# Warnings for the project's own targets, not for those who use them.
function(crumple_warnings target)
    target_compile_options(${target} PRIVATE -Wall -Wextra -Wconversion -Wno-sign-conversion)
    if(CRUMPLE_WERROR)
        target_compile_options(${target} PRIVATE -Werror)
    endif()
endfunction()
