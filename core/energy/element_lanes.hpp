// Numbers of four elements side by side, as functions on lanes hand them over, to the slots of each element.
#pragma once

#include <cstddef>

namespace bb {

/// to[stride lane + k] = numbers[k][lane] for k < n. Host only. Of float and double.
template <class T>
void store_by_element(const T (*numbers)[4], std::size_t n, std::size_t stride, double* to);

}  // namespace bb
