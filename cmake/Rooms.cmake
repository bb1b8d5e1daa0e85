# A room is one folder of the tree: one static library with explicit sources, or headers only.

# One precompiled header (standard library and Eigen) that every room reuses.
file(WRITE "${PROJECT_BINARY_DIR}/pch/empty.cpp.in" "namespace bb {}\n")
configure_file("${PROJECT_BINARY_DIR}/pch/empty.cpp.in" "${PROJECT_BINARY_DIR}/pch/empty.cpp" COPYONLY)
add_library(bb_pch STATIC "${PROJECT_BINARY_DIR}/pch/empty.cpp")
target_link_libraries(bb_pch PUBLIC bb_settings Eigen3::Eigen)
target_compile_options(bb_pch PUBLIC $<$<COMPILE_LANGUAGE:CXX>:-fpch-preprocess>)
target_precompile_headers(bb_pch PRIVATE
  <Eigen/Core> <Eigen/Geometry> <Eigen/SparseCore> <algorithm> <array> <cmath> <cstdint> <functional> <memory>
  <optional> <span> <string> <string_view> <utility> <vector>)

# bb_room(NAME [SOURCES ...] [DEPS ...]): library bb_NAME; without sources an interface library.
function(bb_room name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS" ${ARGN})
  if(ARG_SOURCES)
    add_library(bb_${name} STATIC ${ARG_SOURCES})
    target_link_libraries(bb_${name} PUBLIC bb_pch ${ARG_DEPS})
    target_precompile_headers(bb_${name} REUSE_FROM bb_pch)
  else()
    add_library(bb_${name} INTERFACE)
    target_link_libraries(bb_${name} INTERFACE bb_settings Eigen3::Eigen ${ARG_DEPS})
  endif()
endfunction()

# bb_test(NAME SOURCES ... [DEPS ...]): executable test_NAME whose cases ctest knows one by one.
function(bb_test name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS" ${ARGN})
  add_executable(test_${name} ${ARG_SOURCES})
  target_link_libraries(test_${name} PRIVATE bb_pch ${ARG_DEPS} GTest::gtest GTest::gtest_main)
  target_precompile_headers(test_${name} REUSE_FROM bb_pch)
  target_include_directories(test_${name} PRIVATE "${PROJECT_BINARY_DIR}/generated")
  gtest_discover_tests(test_${name} DISCOVERY_MODE PRE_TEST PROPERTIES TIMEOUT 600)
endfunction()
