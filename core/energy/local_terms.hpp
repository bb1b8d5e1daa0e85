// Local terms of the elements of a family, as the host's assembly scatters them.
#pragma once

#include <cstddef>
#include <vector>

namespace bb {

/// Local terms of n elements of w vertices: what the assembly scatters.
struct LocalTerms {
  std::vector<double> energy;  // [n] J
  std::vector<double> grad;    // [3w n] N, vertex-major
  std::vector<double>
      hess;  // [9w(w + 1)/2 n] N/m, lower blocks (lower_blocks.hpp); empty: there is no Hessian

  /// Allocates n elements of w vertices, and for their Hessians where they have some; allocates only when it must grow.
  void resize(std::size_t n, int width, bool has_hessian = true);
};

}  // namespace bb
