// Storage of local terms.
#include "core/energy/element_batch.hpp"

namespace bb {

void LocalTerms::resize(std::size_t n, int width) {
  const std::size_t dofs = 3 * static_cast<std::size_t>(width);
  energy.resize(n);
  grad.resize(n * dofs);
  hess.resize(n * dofs * dofs);
}

}  // namespace bb
