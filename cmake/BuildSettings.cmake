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

find_program(BB_CCACHE ccache)
if(BB_CCACHE)
  set(CMAKE_C_COMPILER_LAUNCHER "${BB_CCACHE}")
  set(CMAKE_CXX_COMPILER_LAUNCHER "${BB_CCACHE}")
  set(CMAKE_CUDA_COMPILER_LAUNCHER "${BB_CCACHE}")
endif()

# The fused multiply-add setting is fixed: results must not depend on what the compiler contracts, and the
# exact predicates of the audit are wrong if it does.
add_library(bb_settings INTERFACE)
target_include_directories(bb_settings INTERFACE "${PROJECT_SOURCE_DIR}")
target_compile_options(bb_settings INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wconversion -Wshadow -Werror -ffp-contract=off -fPIC>
  $<$<AND:$<BOOL:${BB_NATIVE}>,$<COMPILE_LANGUAGE:CXX>>:-march=native>)
# g++ 12 raises false warnings from Eigen and std::string under these two settings only.
if(BB_SANITIZE OR BB_NATIVE)
  target_compile_options(bb_settings INTERFACE
    $<$<COMPILE_LANGUAGE:CXX>:-Wno-maybe-uninitialized -Wno-restrict>)
endif()
if(BB_SANITIZE)
  target_compile_options(bb_settings INTERFACE
    $<$<COMPILE_LANGUAGE:CXX>:-fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer>)
  target_link_options(bb_settings INTERFACE -fsanitize=address,undefined)
endif()
