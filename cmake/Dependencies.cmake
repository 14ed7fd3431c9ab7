# The libraries cdem stands on: taken from this machine where they are found, fetched at a pinned commit otherwise.
# A fetched library serves this build alone; the installed package looks for its own copy.

include(FetchContent)
list(APPEND CMAKE_MODULE_PATH ${CMAKE_CURRENT_LIST_DIR})

function(cdem_may_fetch library package)
  if(NOT CDEM_FETCH_DEPENDENCIES)
    message(FATAL_ERROR "${library} was not found. Install it (Debian and Ubuntu: ${package}), point CMAKE_PREFIX_PATH at it, "
                        "or let CMake fetch it with -DCDEM_FETCH_DEPENDENCIES=ON.")
  endif()
  message(STATUS "${library} was not found and is fetched")
endfunction()

# Fetches a library that is headers alone and declares `target` for them; its own CMake files are not run.
function(cdem_fetch_headers name target folder repository commit)
  FetchContent_Declare(${name} GIT_REPOSITORY ${repository} GIT_TAG ${commit} SOURCE_SUBDIR no-cmake-wanted)
  FetchContent_MakeAvailable(${name})
  add_library(${target} INTERFACE IMPORTED GLOBAL)
  target_include_directories(${target} SYSTEM INTERFACE ${${name}_SOURCE_DIR}/${folder})
endfunction()

macro(cdem_require_eigen)
  if(NOT TARGET Eigen3::Eigen)
    find_package(Eigen3 3.4 QUIET NO_MODULE)
    if(NOT Eigen3_FOUND)
      cdem_may_fetch("Eigen 3.4" libeigen3-dev)
      cdem_fetch_headers(eigen Eigen3::Eigen . https://gitlab.com/libeigen/eigen.git
                         3147391d946bb4b6c68edd901f2add6ac1f31f8c) # release 3.4.0
    endif()
  endif()
endmacro()

macro(cdem_require_nanoflann)
  if(NOT TARGET nanoflann::nanoflann)
    find_package(nanoflann QUIET MODULE) # cmake/Findnanoflann.cmake
    if(NOT nanoflann_FOUND)
      cdem_may_fetch(nanoflann libnanoflann-dev)
      cdem_fetch_headers(nanoflann nanoflann::nanoflann include https://github.com/jlblancoc/nanoflann.git
                         7812aa08260b6971af2230b1ac446d54f7939822) # release 1.12.1
    endif()
  endif()
endmacro()

macro(cdem_require_cli11)
  if(NOT TARGET CLI11::CLI11)
    find_package(CLI11 QUIET)
    if(NOT CLI11_FOUND)
      cdem_may_fetch(CLI11 libcli11-dev)
      cdem_fetch_headers(cli11 CLI11::CLI11 include https://github.com/CLIUtils/CLI11.git
                         4160d259d961cd393fd8d67590a8c7d210207348) # release 2.5.0
    endif()
  endif()
endmacro()

macro(cdem_require_doctest)
  if(NOT TARGET doctest::doctest)
    find_package(doctest 2.4 QUIET)
    if(NOT doctest_FOUND)
      cdem_may_fetch(doctest doctest-dev)
      cdem_fetch_headers(doctest doctest::doctest . https://github.com/doctest/doctest.git
                         ae7a13539fb71f270b87eb2e874fbac80bc8dda2) # release 2.4.11
    endif()
  endif()
endmacro()

macro(cdem_require_benchmark)
  if(NOT TARGET benchmark::benchmark)
    find_package(benchmark QUIET)
    if(NOT benchmark_FOUND)
      cdem_may_fetch("Google Benchmark" libbenchmark-dev)
      set(BENCHMARK_ENABLE_TESTING OFF)
      set(BENCHMARK_ENABLE_INSTALL OFF)
      FetchContent_Declare(benchmark GIT_REPOSITORY https://github.com/google/benchmark.git
                           GIT_TAG c58e6d0710581e3a08d65c349664128a8d9a2461) # release 1.9.1
      FetchContent_MakeAvailable(benchmark)
    endif()
  endif()
endmacro()
