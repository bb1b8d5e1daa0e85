// Vertices and rest shapes of triangles or tetrahedra as columns of an executor.
#pragma once

#include <string>

#include "core/energy/strain_limit.hpp"
#include "core/resident/elements/element_term.hpp"
#include "core/resident/elements/family_kernels.hpp"

namespace bb::resident {

/// Rest: TriangleRest or TetrahedronRest.
template <class Rest>
struct ElementColumns {
  using Columns = RestColumnsOf<Rest>;
  static constexpr std::size_t n_inverse = Columns::n_inverse;

  ElementColumns(exec::Executor& executor, const std::string& name, std::span<const int> vertices,
                 std::span<const Rest> rests)
      : vertex(executor, name + " vertices"), numbers(executor, name + " rest shapes") {
    const std::size_t n = rests.size();
    vertex.upload(to_columns(vertices, Columns::Inverse::ColsAtCompileTime + 1));
    std::vector<double> columns((n_inverse + 1) * n);
    for (std::size_t e = 0; e < n; ++e) {
      for (std::size_t k = 0; k < n_inverse; ++k) columns[k * n + e] = rests[e].dm_inv.data()[k];
      columns[n_inverse * n + e] = rest_measure(rests[e]);
    }
    numbers.upload(columns);
  }
  Columns rest() const {
    constexpr Index inverse = n_inverse;
    return {numbers.data(), numbers.data() + numbers.size() / (inverse + 1) * inverse};
  }

  exec::Buffer<int> vertex;      // [P, n]
  exec::Buffer<double> numbers;  // [n_inverse + 1, n]
};
using TriangleColumns = ElementColumns<TriangleRest<double>>;
using TetrahedronColumns = ElementColumns<TetrahedronRest<double>>;

}  // namespace bb::resident
