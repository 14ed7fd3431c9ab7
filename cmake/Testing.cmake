# What tests/CMakeLists.txt registers with. One source file is one program is one test;
# the test has the name of its file, without the ending, and the label of its first folder.

set(CDEM_TEST_TIMEOUT 120 CACHE STRING "Seconds after which a test has failed")
find_package(Python3 3.9 REQUIRED COMPONENTS Interpreter) # the checks' own scripts: standard library alone

# A Python with VTK and NumPy, for the tests that read files back. The system's comes first: that is where a
# distribution puts python3-vtk9.
if(NOT CDEM_VTK_PYTHON)
  foreach(candidate IN ITEMS /usr/bin/python3 ${Python3_EXECUTABLE})
    execute_process(COMMAND ${candidate} -c "import numpy, vtkmodules" RESULT_VARIABLE status OUTPUT_QUIET ERROR_QUIET)
    if(status EQUAL 0)
      set(CDEM_VTK_PYTHON ${candidate} CACHE FILEPATH "Python that has VTK and NumPy" FORCE)
      break()
    endif()
  endforeach()
  if(NOT CDEM_VTK_PYTHON)
    message(WARNING "No python3 with vtkmodules and numpy (Debian and Ubuntu: python3-vtk9): tests that need it are skipped")
  endif()
endif()

# Labels the test by its first folder and gives it its time.
function(cdem_describe_test name)
  string(REGEX REPLACE "/.*" "" label ${name})
  set_tests_properties(${name} PROPERTIES LABELS ${label} TIMEOUT ${CDEM_TEST_TIMEOUT})
endfunction()

# cdem_add_program(<name> <variable>): builds tests/<name>.cpp and returns the target's name in <variable>.
function(cdem_add_program name variable)
  string(REPLACE "/" "." target "test.${name}")
  add_executable(${target} ${name}.cpp)
  target_link_libraries(${target} PRIVATE cdem::parallel)
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}) # helpers shared by tests
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests/bin)
  set(${variable} ${target} PARENT_SCOPE)
endfunction()

# cdem_add_test(<name> [UNOPTIMISED]): tests/<name>.cpp holds doctest cases (main is provided) or, under static/ and
# archetypes/, at least compiles. UNOPTIMISED is for tests that run in no time and instantiate much: they compile in half
# the time.
function(cdem_add_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "UNOPTIMISED" "" "")
  cdem_add_program(${name} target)
  target_link_libraries(${target} PRIVATE cdem_doctest_main doctest::doctest)
  if(arg_UNOPTIMISED)
    target_compile_options(${target} PRIVATE -O0)
  else()
    target_precompile_headers(${target} REUSE_FROM cdem_doctest_main)
  endif()
  add_test(NAME ${name} COMMAND ${target} WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR})
  cdem_describe_test(${name})
  if(NOT name MATCHES "^(static|archetypes)/")
    set_tests_properties(${name} PROPERTIES FAIL_REGULAR_EXPRESSION "test cases: +0 ") # a file whose cases were lost
  endif()
endfunction()

# cdem_add_python_test(<name> [WRITER]): runs tests/<name>.py <folder> with a Python that has VTK and NumPy. With
# WRITER, tests/<name>.cpp is a program with its own main that first writes into that folder.
function(cdem_add_python_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "WRITER" "" "")
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/out/${name})
  if(arg_WRITER)
    cdem_add_program(${name} target)
    add_test(NAME ${name}/write COMMAND ${target} ${folder})
    cdem_describe_test(${name}/write)
    set_tests_properties(${name}/write PROPERTIES FIXTURES_SETUP ${name})
    file(MAKE_DIRECTORY ${folder})
  endif()
  if(CDEM_VTK_PYTHON)
    add_test(NAME ${name} COMMAND ${CDEM_VTK_PYTHON} ${CMAKE_CURRENT_SOURCE_DIR}/${name}.py ${folder})
  else()
    set(missing "SKIPPED: no python3 with vtkmodules and numpy (Debian and Ubuntu: python3-vtk9)")
    add_test(NAME ${name} COMMAND ${CMAKE_COMMAND} -E echo ${missing})
    set_tests_properties(${name} PROPERTIES SKIP_REGULAR_EXPRESSION "SKIPPED: no python3")
  endif()
  cdem_describe_test(${name})
  if(arg_WRITER)
    set_tests_properties(${name} PROPERTIES FIXTURES_REQUIRED ${name})
  endif()
endfunction()

# cdem_add_syntax_test(<name>): tests/<name>.cpp instantiates what it is about; the compiler reads it and makes no code.
function(cdem_add_syntax_test name)
  add_test(
    NAME ${name}
    COMMAND ${CMAKE_CXX_COMPILER} -std=c++20 -fsyntax-only ${CMAKE_CURRENT_SOURCE_DIR}/${name}.cpp
            "-I$<JOIN:$<TARGET_PROPERTY:cdem_doctest_main,INCLUDE_DIRECTORIES>,;-I>"
    COMMAND_EXPAND_LISTS)
  cdem_describe_test(${name})
endfunction()

# cdem_add_compile_fail(<name>): tests/compile_fail/<name>.cpp must be refused with the message it asks for, and be
# accepted once repaired; scripts/check_compile_fail says how such a file is written.
function(cdem_add_compile_fail name)
  add_test(
    NAME compile_fail/${name}
    COMMAND
      Python3::Interpreter ${PROJECT_SOURCE_DIR}/scripts/check_compile_fail
      ${CMAKE_CURRENT_SOURCE_DIR}/compile_fail/${name}.cpp -- ${CMAKE_CXX_COMPILER} -std=c++20
      "-I$<JOIN:$<TARGET_PROPERTY:cdem_doctest_main,INCLUDE_DIRECTORIES>,;-I>"
    COMMAND_EXPAND_LISTS)
  cdem_describe_test(compile_fail/${name})
endfunction()
