#include "core/newton/step_size.hpp"

namespace bb {

double embedded_error(const PositionsView& x0, const PositionsView& v0, const PositionsView& x,
                      const PositionsView& v, double h) {
  double largest = 0;
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    largest = std::max(largest, (x.col(i) - x0.col(i) - h / 2 * (v0.col(i) + v.col(i))).norm());
  return largest;
}

}  // namespace bb
