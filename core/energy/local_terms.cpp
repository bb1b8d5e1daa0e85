#include "core/energy/local_terms.hpp"

#include "core/math/lower_blocks.hpp"

namespace bb {

void LocalTerms::resize(std::size_t n, int width, bool has_hessian) {
  const auto w = static_cast<std::size_t>(width);
  energy.resize(n);
  grad.resize(3 * w * n);
  hess.resize(has_hessian ? n_lower_numbers(w) * n : 0);
}

}  // namespace bb
