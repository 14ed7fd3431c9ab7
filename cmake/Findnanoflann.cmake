# Finds nanoflann through its own package file, or by its header where there is none.
#
# Defines nanoflann::nanoflann and nanoflann_FOUND.

find_package(nanoflann QUIET CONFIG)
if(nanoflann_FOUND)
  return()
endif()

find_path(nanoflann_INCLUDE_DIR nanoflann.hpp)
mark_as_advanced(nanoflann_INCLUDE_DIR)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(nanoflann REQUIRED_VARS nanoflann_INCLUDE_DIR)

if(nanoflann_FOUND AND NOT TARGET nanoflann::nanoflann)
  add_library(nanoflann::nanoflann INTERFACE IMPORTED)
  set_target_properties(nanoflann::nanoflann PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${nanoflann_INCLUDE_DIR}")
endif()
