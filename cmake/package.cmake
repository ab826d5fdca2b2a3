# Installation by `cmake --install`, and the package for find_package(crumple), with the targets crumple::crumple,
# crumple::io and crumple::mpi.
include(CMakePackageConfigHelpers)

install(TARGETS crumple EXPORT crumple-targets)
if(TARGET crumple_io)
    set_target_properties(crumple_io PROPERTIES EXPORT_NAME io)
    install(TARGETS crumple_io EXPORT crumple-targets)
endif()
if(TARGET crumple_mpi)
    set_target_properties(crumple_mpi PROPERTIES EXPORT_NAME mpi)
    install(TARGETS crumple_mpi EXPORT crumple-targets)
endif()
if(TARGET crumple_cli)
    install(TARGETS crumple_cli)
endif()
# The licences of third parties exist only if scripts/release.sh has collected them.
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/THIRD_PARTY_LICENSES.txt DESTINATION ${CMAKE_INSTALL_DOCDIR} OPTIONAL)
install(FILES cmake/tsan.supp DESTINATION ${CMAKE_INSTALL_DATADIR}/crumple)
install(DIRECTORY include/crumple DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT crumple-targets NAMESPACE crumple:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/crumple)
configure_package_config_file(cmake/crumple-config.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/crumple-config.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/crumple)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/crumple-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/crumple-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/crumple-config-version.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/crumple)
