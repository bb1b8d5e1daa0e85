// Vertices and rest shapes of triangles as columns of an executor.
#pragma once

#include <string>

#include "core/resident/elements/element_term.hpp"
#include "core/resident/elements/family_kernels.hpp"

namespace bb::resident {

struct TriangleColumns {
  TriangleColumns(exec::Executor& executor, const std::string& name, std::span<const int> vertices,
                  std::span<const TriangleRest<double>> rests)
      : vertex(executor, name + " vertices"), numbers(executor, name + " rest shapes") {
    vertex.upload(to_columns(vertices, 3));
    const std::size_t n = rests.size();
    std::vector<double> columns(5 * n);
    for (std::size_t e = 0; e < n; ++e) {
      for (std::size_t k = 0; k < 4; ++k) columns[k * n + e] = rests[e].dm_inv.data()[k];
      columns[4 * n + e] = rests[e].area;
    }
    numbers.upload(columns);
  }
  RestColumns rest() const { return {numbers.data(), numbers.data() + numbers.size() / 5 * 4}; }

  exec::Buffer<int> vertex;      // [3, n]
  exec::Buffer<double> numbers;  // [5, n]
};

}  // namespace bb::resident
