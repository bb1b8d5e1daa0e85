# Language level, warnings, sanitizers, compiler cache: the same for every target.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")
if(NOT CMAKE_CXX_FLAGS_DEBUG MATCHES "-O")
  set(CMAKE_CXX_FLAGS_DEBUG "-O0 -g1")
endif()

# With CMAKE_UNITY_BUILD (presets release and cuda-compile) the compiler reads up to so many files of a target at once: most of its
# time goes into headers.
set(CMAKE_UNITY_BUILD_BATCH_SIZE 24)

find_program(BB_CCACHE ccache)
if(BB_CCACHE)
  set(CMAKE_C_COMPILER_LAUNCHER "${BB_CCACHE}")
  set(CMAKE_CXX_COMPILER_LAUNCHER "${BB_CCACHE}")
  set(CMAKE_CUDA_COMPILER_LAUNCHER "${BB_CCACHE}")
endif()

# Hardware fused multiply-add and 256-bit vectors: the distance kernels are half their time without them.
set(BB_MARCH "${BB_ARCH}")
if(BB_ARCH STREQUAL "AUTO")
  include(CheckCXXSourceRuns)
  set(CMAKE_REQUIRED_FLAGS "-march=x86-64-v3")
  check_cxx_source_runs("int main() { return __builtin_cpu_supports(\"avx2\") && __builtin_cpu_supports(\"fma\") ? 0 : 1; }"
    BB_RUNS_X86_64_V3)
  unset(CMAKE_REQUIRED_FLAGS)
  if(BB_RUNS_X86_64_V3)
    set(BB_MARCH "x86-64-v3")
  else()
    set(BB_MARCH "BASELINE")
  endif()
endif()
if(NOT BB_MARCH STREQUAL "BASELINE")
  set(BB_MARCH_FLAG "-march=${BB_MARCH}")
endif()

# What decides the generated code beside the build type; records name it (core/base/record). The fused multiply-add
# setting is fixed: results must not depend on what the compiler contracts, and the exact predicates of the audit
# are wrong if it does. Nobody reads errno after mathematics, nor the floating-point flags; keeping them up to date
# forbids vector square roots; neither changes a value.
# Eigen writes its sums and products out one by one, as nvcc's code has them: with its own vectors they have another order, and
# the bits of the program would not be those of a card.
# g++ 12 fuses where it vectorises all the same (a b - c beside a b + c becomes vfmaddsub, whatever -ffp-contract says), so it shall
# not: what is worth lanes has them by name (core/math/lanes.hpp). tests/front/test_contraction.py reads the machine code.
set(BB_CODE_FLAGS -ffp-contract=off -fno-tree-vectorize -DEIGEN_DONT_VECTORIZE -fPIC ${BB_MARCH_FLAG} -fno-math-errno -fno-trapping-math)
add_library(bb_settings INTERFACE)
target_include_directories(bb_settings INTERFACE "${PROJECT_SOURCE_DIR}")
target_compile_options(bb_settings INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wconversion -Wshadow -Werror ${BB_CODE_FLAGS}>)
# g++ looks for memory to give back only above 1 GiB: it takes a sixteenth of its time, and few files need that much.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(bb_settings INTERFACE $<$<COMPILE_LANGUAGE:CXX>:--param=ggc-min-heapsize=1048576>)
endif()
# g++ 12 raises false warnings from Eigen and std::string under these two settings only.
if(BB_SANITIZE OR BB_MARCH_FLAG)
  target_compile_options(bb_settings INTERFACE
    $<$<COMPILE_LANGUAGE:CXX>:-Wno-maybe-uninitialized -Wno-restrict>)
endif()
if(BB_SANITIZE)
  target_compile_options(bb_settings INTERFACE
    $<$<COMPILE_LANGUAGE:CXX>:-fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer>)
  target_link_options(bb_settings INTERFACE -fsanitize=address,undefined)
endif()
# Fuzzing: what the sanitizers of clang see, and coverage for libFuzzer. Warnings are judged by the g++ builds.
if(BB_FUZZ)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    message(FATAL_ERROR "BB_FUZZ needs clang++ with libFuzzer, not ${CMAKE_CXX_COMPILER_ID}: use ./bench dev fuzz or the preset fuzz")
  endif()
  target_compile_options(bb_settings INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-w
    -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer>)
  target_link_options(bb_settings INTERFACE -fsanitize=address,undefined)
endif()
