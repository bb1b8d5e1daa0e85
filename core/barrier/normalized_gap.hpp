// What every shape starts from: the gap in units of d_hat, without cancellation near d_hat. Element math.
#pragma once

#include "core/barrier/shape.hpp"
#include "core/math/host_device.hpp"
#include "core/math/log.hpp"

namespace bb::shapes {

/// u = d/d_hat and e = 1 - u. The difference d_hat - d is exact for d >= d_hat/2 (Sterbenz), so e keeps full
/// relative precision up to the last gap below d_hat.
template <class T>
struct NormalizedGap {
  T u, e;
  BB_HD NormalizedGap(T d, T d_hat) : u(d / d_hat), e((d_hat - d) / d_hat) {}

  /// -ln u >= 0: from e near d_hat, from u near contact, each where it is the accurate one.
  BB_HD T minus_log() const { return elementary::minus_log(u, e); }
};

}  // namespace bb::shapes
