// Derivatives against finite differences in long double.
#pragma once

#include <functional>

#include "tests/oracle/dense.hpp"

namespace bb::test {

/// Smallest relative error, over steps 1e-2 .. 1e-9, of fourth-order differences of f: R^N -> R^M against
/// `jacobian` [M x N]; relative to its largest entry. Infinite when the jacobian is zero, so that nothing
/// passes by being empty.
double jacobian_error(const std::function<VecXl(const VecXl&)>& f, const VecXl& x, const MatXd& jacobian);

/// The same of a number and its gradient [N].
double gradient_error(const std::function<Long(const VecXl&)>& f, const VecXl& x, const VecXd& gradient);

}  // namespace bb::test
