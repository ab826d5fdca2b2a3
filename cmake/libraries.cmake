# Installed libraries, which are shared if BUILD_SHARED_LIBS is on. Shared ones export only symbols marked CRUMPLE_API
# (include/crumple/export.h). Their SOVERSION has the minor version, because that one may change the ABI before 1.0.

# crumple_library(TARGET SOURCES...): adds an installed library.
function(crumple_library target)
    add_library(${target} ${ARGN})
    set_target_properties(${target} PROPERTIES
        VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
    if(BUILD_SHARED_LIBS)
        target_compile_definitions(${target} PUBLIC CRUMPLE_SHARED)
        if(NOT CRUMPLE_SANITIZE)
            target_link_options(${target} PRIVATE LINKER:-z,defs)  # reports symbols that another library hides
        endif()
    endif()
endfunction()

# crumple_names(TARGET NAME): defines crumple::NAME for an installed library; to be called after its last
# target_link_libraries. The project's own programs and tests use symbols that shared libraries hide: for them,
# crumple::NAME is a static library of the same objects.
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
