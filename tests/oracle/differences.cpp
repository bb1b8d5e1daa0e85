#include "tests/oracle/differences.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace bb::test {

double jacobian_error(const std::function<VecXl(const VecXl&)>& f, const VecXl& x, const MatXd& jacobian) {
  if (f(x).size() != jacobian.rows() || x.size() != jacobian.cols()) {
    throw std::invalid_argument("jacobian_error: sizes do not match");
  }
  const double scale = jacobian.cwiseAbs().maxCoeff();
  double best = std::numeric_limits<double>::infinity();
  if (!(scale > 0)) return best;
  MatXd differences(jacobian.rows(), jacobian.cols());
  for (Long h = 1e-2L; h > 0.5e-9L; h /= 10) {
    for (Eigen::Index j = 0; j < x.size(); ++j) {
      const auto at = [&](Long step) {
        VecXl moved = x;
        moved[j] += step;
        return f(moved);
      };
      const VecXl column = (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h);
      differences.col(j) = column.cast<double>();
    }
    const double worst = (differences - jacobian).cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
    best = std::min(best, worst / scale);  // NaN is never best
  }
  return best;
}

double gradient_error(const std::function<Long(const VecXl&)>& f, const VecXl& x, const VecXd& gradient) {
  const auto vector = [&](const VecXl& at) { return VecXl(VecXl::Constant(1, f(at))); };
  return jacobian_error(vector, x, gradient.transpose());
}

}  // namespace bb::test
