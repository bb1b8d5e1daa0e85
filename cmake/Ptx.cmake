# Tests that run nvcc's PTX on the CPU (tests/ptx), linked with the modules of the program itself.
find_package(Python3 REQUIRED COMPONENTS Interpreter)
file(GLOB BB_PTX_TRANSLATOR CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/tests/ptx/translator/*.py")

# bb_ptx_module(NAME SOURCE file.cu): object library NAME, the PTX of the file as C++.
function(bb_ptx_module name)
  cmake_parse_arguments(ARG "" "SOURCE" "" ${ARGN})
  cmake_path(ABSOLUTE_PATH ARG_SOURCE)
  set(ptx "${CMAKE_CURRENT_BINARY_DIR}/${name}.ptx")
  set(eigen "$<TARGET_PROPERTY:Eigen3::Eigen,INTERFACE_INCLUDE_DIRECTORIES>")
  add_custom_command(OUTPUT "${ptx}"
    COMMAND "${CMAKE_CUDA_COMPILER}" -ptx -arch=sm_90 -std=c++20 -O3 -DNDEBUG --fmad=false -Xcompiler=-ffp-contract=off
      --expt-relaxed-constexpr --diag-suppress=20012 -Werror=cross-execution-space-call "-I${PROJECT_SOURCE_DIR}"
      "-I${PROJECT_BINARY_DIR}/generated" "-I$<JOIN:${eigen},;-I>" -MD -MF "${ptx}.d" -MT "${ptx}" -o "${ptx}"
      "${ARG_SOURCE}"
    DEPENDS "${ARG_SOURCE}" DEPFILE "${ptx}.d" COMMAND_EXPAND_LISTS VERBATIM COMMENT "PTX of ${name}")
  bb_ptx_translation(${name} "${ptx}" "")
  bb_ptx_translation(${name}_faults "${ptx}" --faults)
  set_target_properties(${name}_faults PROPERTIES EXCLUDE_FROM_ALL ON)
endfunction()

# bb_ptx_of_device_code(NAME MODULE): the same of the kernels of a module: the PTX in the object file that the
# program is linked from, which all its machine code is made of.
function(bb_ptx_of_device_code name module)
  set(ptx "${CMAKE_CURRENT_BINARY_DIR}/${name}.ptx")
  set(script "${PROJECT_SOURCE_DIR}/tests/ptx/embedded_ptx.py")
  add_custom_command(OUTPUT "${ptx}"
    COMMAND "${Python3_EXECUTABLE}" "${script}" "$<TARGET_OBJECTS:bb_device_${module}>" "${ptx}"
    DEPENDS "$<TARGET_OBJECTS:bb_device_${module}>" "${script}" VERBATIM COMMENT "PTX of the program's ${module} kernels")
  bb_ptx_translation(${name} "${ptx}" "")
  bb_ptx_translation(${name}_faults "${ptx}" --faults)
  set_target_properties(${name}_faults PROPERTIES EXCLUDE_FROM_ALL ON)
endfunction()

# bb_ptx_translation(NAME PTX OPTION): object library NAME; messages know it by the name of the PTX.
function(bb_ptx_translation name ptx option)
  set(cpp "${CMAKE_CURRENT_BINARY_DIR}/${name}_ptx.cpp")
  cmake_path(GET ptx STEM module)
  add_custom_command(OUTPUT "${cpp}"
    COMMAND "${Python3_EXECUTABLE}" "${PROJECT_SOURCE_DIR}/tests/ptx/translate.py" "${ptx}" "${cpp}" --module "${module}" ${option}
    DEPENDS "${ptx}" "${PROJECT_SOURCE_DIR}/tests/ptx/translate.py" ${BB_PTX_TRANSLATOR} VERBATIM COMMENT "Translating the PTX of ${name}")
  add_library(${name} OBJECT "${cpp}")
  # A function may have ten thousand lines: the optimiser's first level, and none of its passes that grow faster.
  target_compile_options(${name} PRIVATE -w -O1 ${BB_CODE_FLAGS})
  target_include_directories(${name} PRIVATE "${PROJECT_SOURCE_DIR}")
endfunction()

# bb_ptx_test(NAME LEAST n MODULES ... [USES ...] SOURCES ... [CASES target] [LIBRARIES libraries ...] [SKIP cases]): test_NAME,
# one test of ctest without the cases of a pattern of GoogleTest, which also fails when less than LEAST per cent of the
# instructions of one of its MODULES ran; those that it only USES are judged elsewhere. CASES: another test, whose objects
# are linked once more. test_NAME_faults, built on demand: the same with switches for inject_faults.py.
function(bb_ptx_test name)
  cmake_parse_arguments(ARG "" "CASES;LEAST;SKIP" "MODULES;USES;SOURCES;LIBRARIES" ${ARGN})
  add_library(${name}_cases OBJECT ${ARG_SOURCES} "${PROJECT_SOURCE_DIR}/tests/ptx/main.cpp")
  set_target_properties(${name}_cases PROPERTIES UNITY_BUILD ON)
  target_link_libraries(${name}_cases PRIVATE bb_joined)
  target_link_libraries(${name}_cases PUBLIC bb_test_pch)
  target_precompile_headers(${name}_cases REUSE_FROM bb_test_pch)
  target_compile_definitions(${name}_cases PRIVATE BB_PTX_LEAST=${ARG_LEAST} "BB_PTX_SKIP=\"${ARG_SKIP}\""
    "BB_PTX_MODULES=\"$<JOIN:${ARG_MODULES}, >\"")
  target_include_directories(${name}_cases PRIVATE "${PROJECT_BINARY_DIR}/generated")
  set(objects $<TARGET_OBJECTS:${name}_cases>)
  if(ARG_CASES)
    list(APPEND objects $<TARGET_OBJECTS:${ARG_CASES}>)
  endif()
  foreach(kind "" _faults)
    set(modules ${ARG_MODULES} ${ARG_USES})
    list(TRANSFORM modules APPEND "${kind}")
    add_executable(test_${name}${kind} ${objects})
    set_target_properties(test_${name}${kind} PROPERTIES LINKER_LANGUAGE CXX)
    target_link_libraries(test_${name}${kind} PRIVATE ${modules} bb_ptx_machine ${ARG_LIBRARIES} GTest::gtest TBB::tbb fmt::fmt)
  endforeach()
  set_target_properties(test_${name}_faults PROPERTIES EXCLUDE_FROM_ALL ON)
  add_test(NAME ptx.${name} COMMAND test_${name})
  # The longest of all: they begin first, so that none is left alone at the end.
  set_tests_properties(ptx.${name} PROPERTIES TIMEOUT 600 COST 1000 LABELS ${name})
endfunction()
