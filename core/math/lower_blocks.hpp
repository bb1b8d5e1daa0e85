// A symmetric matrix of 3 x 3 blocks kept as its lower blocks, column by column: how local Hessians travel
// from the elements and contacts to the assembly.
#pragma once

#include <cstddef>
#include <functional>

#include "core/math/host_device.hpp"

namespace bb {

/// Blocks kept of a matrix on `width` points, and the numbers in them.
constexpr std::size_t n_lower_blocks(std::size_t width) { return width * (width + 1) / 2; }
constexpr std::size_t n_lower_numbers(std::size_t width) { return 9 * n_lower_blocks(width); }

/// Number of the block of points (a, b), width > a >= b; its nine entries, column-major, begin at 9 times it.
constexpr std::size_t lower_block(std::size_t width, std::size_t a, std::size_t b) {
  return b * (2 * width - b + 1) / 2 + (a - b);
}

/// f(row, column) of each of these numbers, in their order.
template <class F>
BB_HD void for_each_lower_number(int width, const F& f) {
  for (int b = 0; b < width; ++b) {
    for (int a = b; a < width; ++a) {
      for (int c = 0; c < 3; ++c) {
        for (int r = 0; r < 3; ++r) f(3 * a + r, 3 * b + c);
      }
    }
  }
}

/// The lower blocks of the 3 width x 3 width matrix m, entry by entry through `number`, written
/// to blocks [n_lower_numbers(width)].
template <class Matrix, class Number = std::identity>
void store_lower_blocks(int width, const Matrix& m, double* blocks, const Number& number = {}) {
  for_each_lower_number(width, [&](int row, int column) { *blocks++ = number(m(row, column)); });
}

}  // namespace bb
