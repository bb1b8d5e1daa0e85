// A shape on the squared gap, seen as a function of the gap. Host-device.
#pragma once

#include <limits>

#include "core/math/host_device.hpp"

namespace bb {

/// Chain rule from f(D; D_hat), D = d^2, to b(d) = f(d^2; d_hat^2)/d_hat^2, in place; d2b comes in as f''.
///   b' = 2 d f'/d_hat^2,   b'' = (2 f' + 4 d^2 f'')/d_hat^2
/// Where d^2 is 0 the limit of a shape that is infinite there is (inf, -inf, inf), else the f'' term is 0.
template <class T>
BB_HD inline void chain_squared_gap(bool infinite_at_zero, T d, T d_sq, T d_hat_sq, T& b, T& db, T& d2b) {
  if (d_sq == T(0)) {
    const T inf = std::numeric_limits<T>::infinity();
    const T slope = db;
    b = infinite_at_zero ? inf : b / d_hat_sq;
    db = infinite_at_zero ? -inf : T(0);
    d2b = infinite_at_zero ? inf : T(2) * slope / d_hat_sq;
    return;
  }
  d2b = (T(2) * db + T(4) * d_sq * d2b) / d_hat_sq;
  db = T(2) * d * db / d_hat_sq;
  b = b / d_hat_sq;
}

}  // namespace bb
