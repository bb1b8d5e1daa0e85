# A module is one folder of the tree: one static library with explicit sources, or headers only.

# Three precompiled headers: standard library and Eigen, which most modules reuse; the same with what modules that read and write include
# beside; and with what tests do.
file(WRITE "${PROJECT_BINARY_DIR}/pch/empty.cpp.in" "namespace bb {}\n")
configure_file("${PROJECT_BINARY_DIR}/pch/empty.cpp.in" "${PROJECT_BINARY_DIR}/pch/empty.cpp" COPYONLY)
function(bb_precompile name)
  add_library(${name} STATIC "${PROJECT_BINARY_DIR}/pch/empty.cpp")
  target_link_libraries(${name} PUBLIC bb_settings Eigen3::Eigen)
  target_compile_options(${name} PUBLIC $<$<COMPILE_LANGUAGE:CXX>:-fpch-preprocess>)
  target_precompile_headers(${name} PRIVATE
    <Eigen/Core> <Eigen/Geometry> <Eigen/SparseCore> <algorithm> <array> <cmath> <cstdint> <functional> <memory>
    <optional> <span> <string> <string_view> <utility> <vector> ${ARGN})
endfunction()
bb_precompile(bb_pch)

# COLD modules: text in, text out, once a run, a third of the program's code. Release compiles them for size, which takes g++ two thirds of
# the time and gives the same bits (core/base/record/CMakeLists.txt names it among the flags).
bb_precompile(bb_cold_pch <fmt/format.h> <fmt/ranges.h> <nlohmann/json.hpp> <filesystem> <fstream> <limits> <map> <numeric> <set>
  <sstream> <variant>)
target_link_libraries(bb_cold_pch PUBLIC fmt::fmt nlohmann_json::nlohmann_json)
set(BB_COLD_FLAG $<$<AND:$<CONFIG:Release>,$<COMPILE_LANGUAGE:CXX>>:-Os>)
target_compile_options(bb_cold_pch PRIVATE ${BB_COLD_FLAG})
function(bb_cold target)
  target_link_libraries(${target} PRIVATE fmt::fmt nlohmann_json::nlohmann_json)
  target_precompile_headers(${target} REUSE_FROM bb_cold_pch)
  target_compile_options(${target} PRIVATE ${BB_COLD_FLAG} -fpch-preprocess)
endfunction()
if(BB_TESTS)
  # Not nlohmann/json.hpp: its operators of literals would have every test translate a parser, a second of g++ each.
  bb_precompile(bb_test_pch <gtest/gtest.h> <tbb/global_control.h> <tbb/parallel_for.h> <tbb/parallel_reduce.h>
    <filesystem> <fstream> <limits> <map> <numeric> <random> <set> <sstream>)
  target_link_libraries(bb_test_pch PUBLIC GTest::gtest TBB::tbb fmt::fmt nlohmann_json::nlohmann_json)
  # What is tested is compiled as the program is; its tests, two thirds of all files, in a quarter less time and with the same bits.
  target_compile_options(bb_test_pch PUBLIC $<$<AND:$<CONFIG:Release>,$<COMPILE_LANGUAGE:CXX>>:-O1>)
endif()

# bb_declare_module(NAME FOLDER [DEPS ...]): the files below FOLDER include no module but those that DEPS names as bb_<module>.
function(bb_declare_module name folder)
  cmake_parse_arguments(ARG "" "" "DEPS" ${ARGN})
  set(needs "")
  foreach(dep IN LISTS ARG_DEPS)
    if(dep MATCHES "^bb_(.*)$")
      list(APPEND needs "${CMAKE_MATCH_1}")
    endif()
  endforeach()
  if(NOT needs)
    set(needs "-")
  endif()
  list(JOIN needs "," needs)
  set_property(GLOBAL APPEND PROPERTY BB_MODULES "${name}|${folder}|${needs}")
endfunction()

# bb_linked_modules(NAME OUT): the modules whose libraries that of module NAME is linked with, DEPS or not, separated by commas; "-" for none.
function(bb_linked_modules name out)
  set(linked "")
  if(TARGET bb_${name})
    foreach(property LINK_LIBRARIES INTERFACE_LINK_LIBRARIES)
      get_target_property(libraries bb_${name} ${property})
      string(REGEX MATCHALL "bb_[a-z_]+" found "${libraries}")
      list(APPEND linked ${found})
    endforeach()
    list(TRANSFORM linked REPLACE "^bb_" "")
    list(REMOVE_DUPLICATES linked)
  endif()
  list(JOIN linked "," linked)
  if(linked STREQUAL "")
    set(linked "-")
  endif()
  set(${out} "${linked}" PARENT_SCOPE)
endfunction()

# bb_check_modules(): a build refuses an #include of a module that is not named (ModuleCheck.cmake). Called last.
function(bb_check_modules)
  get_property(modules GLOBAL PROPERTY BB_MODULES)
  set(text "")
  foreach(module IN LISTS modules)
    string(REGEX REPLACE "[|].*" "" name "${module}")
    bb_linked_modules("${name}" linked)
    string(APPEND text "${module}|${linked}\n")
  endforeach()
  file(CONFIGURE OUTPUT "${PROJECT_BINARY_DIR}/modules.txt" CONTENT "${text}" @ONLY)
  set(files "")
  foreach(top core barriers experiments python)
    file(GLOB_RECURSE found CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/${top}/*.[hc]pp" "${PROJECT_SOURCE_DIR}/${top}/*.[hc]"
      "${PROJECT_SOURCE_DIR}/${top}/*.cu" "${PROJECT_SOURCE_DIR}/${top}/*.cuh" "${PROJECT_SOURCE_DIR}/${top}/*.in"
      "${PROJECT_SOURCE_DIR}/${top}/*.inc")
    list(APPEND files ${found})
  endforeach()
  set(stamp "${PROJECT_BINARY_DIR}/modules.stamp")
  add_custom_command(OUTPUT "${stamp}"
    COMMAND "${CMAKE_COMMAND}" "-DMODULES=${PROJECT_BINARY_DIR}/modules.txt" "-DSOURCE_DIR=${PROJECT_SOURCE_DIR}"
      "-DSTAMP=${stamp}" -P "${PROJECT_SOURCE_DIR}/cmake/ModuleCheck.cmake"
    DEPENDS ${files} "${PROJECT_BINARY_DIR}/modules.txt" "${PROJECT_SOURCE_DIR}/cmake/ModuleCheck.cmake"
    COMMENT "Checking that modules include only modules that they name" VERBATIM)
  add_custom_target(bb_modules ALL DEPENDS "${stamp}")
  get_property(targets GLOBAL PROPERTY BB_MODULE_TARGETS)
  foreach(target IN LISTS targets)
    add_dependencies(${target} bb_modules)
  endforeach()
endfunction()

# bb_module(NAME [COLD] [FOLDER path] [SOURCES ...] [DEPS ...]): library bb_NAME of the files in FOLDER (this one by default);
# without sources an interface library. DEPS names every module that these files include.
function(bb_module name)
  cmake_parse_arguments(ARG "COLD" "FOLDER" "SOURCES;DEPS" ${ARGN})
  if(NOT ARG_FOLDER)
    file(RELATIVE_PATH ARG_FOLDER "${PROJECT_SOURCE_DIR}" "${CMAKE_CURRENT_SOURCE_DIR}")
  endif()
  bb_declare_module(${name} "${ARG_FOLDER}" DEPS ${ARG_DEPS})
  if(ARG_SOURCES)
    add_library(bb_${name} STATIC ${ARG_SOURCES})
    target_link_libraries(bb_${name} PUBLIC bb_pch ${ARG_DEPS})
    if(ARG_COLD)
      bb_cold(bb_${name})
    else()
      target_precompile_headers(bb_${name} REUSE_FROM bb_pch)
    endif()
    set_property(GLOBAL APPEND PROPERTY BB_MODULE_TARGETS bb_${name})
  else()
    add_library(bb_${name} INTERFACE)
    target_link_libraries(bb_${name} INTERFACE bb_settings Eigen3::Eigen ${ARG_DEPS})
  endif()
endfunction()

# Where CMAKE_UNITY_BUILD is on, the tests of a module are compiled many files at once: each has a namespace of its own. That a local of
# one file hides a helper of another shows nothing; where files are read one by one (preset dev) it is judged. So are array bounds: joined,
# g++ 12 takes the padding of Eigen's three integers for foreign memory.
add_library(bb_joined INTERFACE)
target_compile_options(bb_joined INTERFACE -Wno-shadow -Wshadow=local -Wno-array-bounds)

# bb_test(NAME SOURCES ... [DEPS ...]): executable test_NAME whose cases ctest knows one by one.
function(bb_test name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS" ${ARGN})
  add_executable(test_${name} ${ARG_SOURCES})
  target_link_libraries(test_${name} PRIVATE bb_test_pch ${ARG_DEPS} GTest::gtest GTest::gtest_main)
  target_precompile_headers(test_${name} REUSE_FROM bb_test_pch)
  target_include_directories(test_${name} PRIVATE "${PROJECT_BINARY_DIR}/generated")
  if(CMAKE_UNITY_BUILD)
    target_link_libraries(test_${name} PRIVATE bb_joined)
  endif()
  gtest_discover_tests(test_${name} DISCOVERY_MODE PRE_TEST PROPERTIES TIMEOUT 600 LABELS ${name})
endfunction()
