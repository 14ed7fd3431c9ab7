# Installs the headers, the CMake package (find_package(cdem)) and the pkg-config file.

include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_DATADIR}/cmake/cdem) # headers alone: nothing here depends on the processor

install(TARGETS cdem cdem_parallel EXPORT cdem-targets FILE_SET HEADERS FILE_SET internals)
install(EXPORT cdem-targets NAMESPACE cdem:: DESTINATION ${package_dir})

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/cdem-config.cmake.in ${PROJECT_BINARY_DIR}/cdem-config.cmake
                              INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/cdem-config-version.cmake COMPATIBILITY SameMinorVersion
                                 ARCH_INDEPENDENT)
install(FILES ${PROJECT_BINARY_DIR}/cdem-config.cmake ${PROJECT_BINARY_DIR}/cdem-config-version.cmake
              ${CMAKE_CURRENT_LIST_DIR}/Findnanoflann.cmake
        DESTINATION ${package_dir})

# The prefix is written relative to the file itself, so that a moved installation still works.
file(RELATIVE_PATH pc_to_prefix /${CMAKE_INSTALL_DATADIR}/pkgconfig /)
configure_file(${CMAKE_CURRENT_LIST_DIR}/cdem.pc.in ${PROJECT_BINARY_DIR}/cdem.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/cdem.pc DESTINATION ${CMAKE_INSTALL_DATADIR}/pkgconfig)
