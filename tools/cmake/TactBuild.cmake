# Build rules used by every folder: warnings, sanitizers, one library a folder.
include(GNUInstallDirs)

option(TACT_BUILD_TESTS "Build the unit and system tests" ON)
set(TACT_SANITIZE "" CACHE STRING "Sanitizers, comma separated: address,undefined or thread")

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
if(NOT CMAKE_BUILD_TYPE)
  # A haptic loop built without optimisation looks like a broken network.
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()
find_program(TACT_CCACHE ccache)
if(TACT_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER "${TACT_CCACHE}")
  set(CMAKE_C_COMPILER_LAUNCHER "${TACT_CCACHE}")
endif()

# One place for programs and data in the build tree, laid out as in the installed tree,
# so that a program finds its files the same way in both: <prefix>/bin, <prefix>/libexec/tact, <prefix>/share/tact.
set(TACT_BIN_DIR "${CMAKE_BINARY_DIR}/bin")
set(TACT_LIBEXEC_DIR "${CMAKE_BINARY_DIR}/libexec/tact")
set(TACT_SHARE_DIR "${CMAKE_BINARY_DIR}/share/tact")

if(TACT_SANITIZE)
  string(REPLACE "," ";" _tact_sanitizers "${TACT_SANITIZE}")
  foreach(_s IN LISTS _tact_sanitizers)
    add_compile_options(-fsanitize=${_s})
    add_link_options(-fsanitize=${_s})
  endforeach()
  add_compile_options(-O1 -fno-omit-frame-pointer -fno-sanitize-recover=all)  # Eigen without it: ten times slower
  add_compile_definitions(TACT_SANITIZED=1)  # allocation guard and memory locking off
endif()

option(TACT_FUZZ "Build the fuzz targets of tests/fuzz (clang only)" OFF)
if(TACT_FUZZ)
  add_compile_options(-fsanitize=fuzzer-no-link)  # the fuzzer sees which branches of the product an input takes
endif()

add_library(tact_warnings INTERFACE)
target_compile_options(tact_warnings INTERFACE -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror)

# tact_library(tact_name sources...): the library of the current folder. Headers are included as
# "name/of/folder/file.hpp" from the roots common/ and services/.
function(tact_library name)
  if(ARGN)
    add_library(${name} STATIC ${ARGN})
    target_include_directories(${name} PUBLIC "${PROJECT_SOURCE_DIR}/common" "${PROJECT_SOURCE_DIR}/services")
    target_link_libraries(${name} PRIVATE tact_warnings)
  else()
    add_library(${name} INTERFACE)
    target_include_directories(${name} INTERFACE "${PROJECT_SOURCE_DIR}/common" "${PROJECT_SOURCE_DIR}/services")
  endif()
endfunction()

# tact_program(tact-name [LIBEXEC] sources...): a program; services and helpers of users' programs go to libexec.
function(tact_program name)
  cmake_parse_arguments(ARG "LIBEXEC" "" "" ${ARGN})
  add_executable(${name} ${ARG_UNPARSED_ARGUMENTS})
  target_include_directories(${name} PRIVATE "${PROJECT_SOURCE_DIR}/common" "${PROJECT_SOURCE_DIR}/services")
  target_link_libraries(${name} PRIVATE tact_warnings)
  if(ARG_LIBEXEC)
    set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${TACT_LIBEXEC_DIR}")
    install(TARGETS ${name} DESTINATION "${CMAKE_INSTALL_LIBEXECDIR}/tact")
  else()
    set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${TACT_BIN_DIR}")
    install(TARGETS ${name} DESTINATION "${CMAKE_INSTALL_BINDIR}")
  endif()
endfunction()

# tact_data(target folder files...): files of the current folder, copied to share/tact/<folder> and installed there.
function(tact_data target folder)
  set(copies)
  foreach(file IN LISTS ARGN)
    set(copy "${TACT_SHARE_DIR}/${folder}/${file}")
    add_custom_command(OUTPUT "${copy}" DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/${file}"
      COMMAND "${CMAKE_COMMAND}" -E copy "${CMAKE_CURRENT_SOURCE_DIR}/${file}" "${copy}")
    list(APPEND copies "${copy}")
  endforeach()
  file(MAKE_DIRECTORY "${TACT_SHARE_DIR}/${folder}")
  add_custom_target(${target} ALL DEPENDS ${copies})
  install(FILES ${ARGN} DESTINATION "${CMAKE_INSTALL_DATADIR}/tact/${folder}")
endfunction()

# tact_test(name sources... LIBS libs... [LABELS l...]): one GoogleTest program, discovered by CTest.
function(tact_test name)
  cmake_parse_arguments(ARG "" "" "LIBS;LABELS" ${ARGN})
  add_executable(${name} ${ARG_UNPARSED_ARGUMENTS})
  target_include_directories(${name} PRIVATE "${PROJECT_SOURCE_DIR}/common" "${PROJECT_SOURCE_DIR}/services" "${PROJECT_SOURCE_DIR}/tests")
  target_link_libraries(${name} PRIVATE tact_warnings ${ARG_LIBS} GTest::gtest GTest::gtest_main)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/tests")
  # System tests kill processes, and RouDi is one for the whole machine: never two at once.
  set(serial FALSE)
  if("system" IN_LIST ARG_LABELS)
    set(serial TRUE)
  endif()
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST
    PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT 300 RUN_SERIAL ${serial})
endfunction()

# Third-party headers are SYSTEM through imported targets: warnings are for our code only.
find_package(Threads REQUIRED)
find_package(CycloneDDS REQUIRED)
find_package(Eigen3 REQUIRED NO_MODULE)
find_package(TBB REQUIRED)
find_package(embree 3 REQUIRED)
find_package(assimp REQUIRED)
find_package(spdlog REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(CLI11 REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(hwy REQUIRED)
if(TACT_BUILD_TESTS)
  find_package(GTest REQUIRED)
  include(GoogleTest)
endif()
