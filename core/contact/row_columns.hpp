// Numbers of a row in the columns of tables and of stored Hessians.
#pragma once

#include <vector>

#include "core/math/lower_blocks.hpp"

namespace bb {

/// Numbers that the Hessian of a row is stored in.
inline constexpr std::size_t row_hessian_numbers = n_lower_numbers(4);

/// Entry r of a column, in the scalar T.
template <class T>
T entry(const std::vector<double>& column, std::size_t r) {
  return static_cast<T>(column[r]);
}

}  // namespace bb
