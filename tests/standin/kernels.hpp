// What runs kernels for the stand-in: the translated PTX (kernels.cpp).
#pragma once

#include <cstddef>

namespace standin {

/// Device memory that kernels may touch.
void add_kernel_memory(const void* p, std::size_t bytes);
void remove_kernel_memory(const void* p);

}  // namespace standin
