# BUILD_SHARED_LIBS makes the installed libraries shared. They hide all but what is marked CRUMPLE_API
# (include/crumple/export.h), and are named by the minor version, for before 1.0 that one may change the ABI.

# crumple_library(TARGET SOURCES...): one of them.
function(crumple_library target)
    add_library(${target} ${ARGN})
    set_target_properties(${target} PROPERTIES
        VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
    if(BUILD_SHARED_LIBS)
        target_compile_definitions(${target} PUBLIC CRUMPLE_SHARED)
        if(NOT CRUMPLE_SANITIZE)
            target_link_options(${target} PRIVATE LINKER:-z,defs)  # what another library hides is missed here
        endif()
    endif()
endfunction()

# crumple_names(TARGET NAME): calls the library crumple::NAME, once it has all that it links. The project's own programs
# and tests see what shared libraries hide: for them that is a static library of the same objects.
function(crumple_names target name)
    if(NOT BUILD_SHARED_LIBS OR NOT PROJECT_IS_TOP_LEVEL)
        add_library(crumple::${name} ALIAS ${target})
        return()
    endif()
    add_library(${target}_inside STATIC $<TARGET_OBJECTS:${target}>)
    add_library(crumple::${name} ALIAS ${target}_inside)
    set_target_properties(${target}_inside PROPERTIES LINKER_LANGUAGE CXX)
    target_compile_features(${target}_inside PUBLIC cxx_std_20)
    target_include_directories(${target}_inside PUBLIC ${PROJECT_SOURCE_DIR}/include)
    get_target_property(libraries ${target} LINK_LIBRARIES)
    list(TRANSFORM libraries REPLACE "^crumple$" crumple_inside)
    target_link_libraries(${target}_inside PUBLIC ${libraries})
endfunction()
