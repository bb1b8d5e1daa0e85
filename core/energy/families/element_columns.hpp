// Elements as columns of an executor's memory: vertices and rest shapes.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <vector>

#include "core/energy/families/rest_kernels.hpp"
#include "core/energy/strain_limit.hpp"
#include "core/exec/buffer.hpp"

namespace bb {

/// element-major [width n] to columns [width, n].
template <class T>
std::vector<T> to_columns(std::span<const T> rows, std::size_t width) {
  const std::size_t n = width == 0 ? 0 : rows.size() / width;
  std::vector<T> out(rows.size());
  for (std::size_t e = 0; e < n; ++e) {
    for (std::size_t k = 0; k < width; ++k) out[k * n + e] = rows[width * e + k];
  }
  return out;
}

/// Whether an entry of the column is above 0.
inline bool any_positive(std::span<const double> column) {
  return std::any_of(column.begin(), column.end(), [](double value) { return value > 0; });
}

/// Two columns [n] one after the other.
inline void upload_pair(std::span<const double> first, std::span<const double> second,
                        exec::Buffer<double>& out) {
  std::vector<double> both(first.begin(), first.end());
  both.insert(both.end(), second.begin(), second.end());
  out.upload(both);
}

/// Element-major vertices of elements of a scene.
template <std::size_t W>
std::vector<int> flat(const std::vector<std::array<int, W>>& elements) {
  std::vector<int> out;
  out.reserve(W * elements.size());
  for (const auto& element : elements) out.insert(out.end(), element.begin(), element.end());
  return out;
}

/// Rest shapes as they are stored: TriangleRest or TetrahedronRest.
template <class Rest>
struct RestShapes {
  using Columns = RestColumnsOf<Rest>;

  RestShapes(exec::Executor& executor, const std::string& name, std::span<const Rest> rests)
      : numbers(executor, name) {
    set(rests);
  }
  /// As many as there are.
  void set(std::span<const Rest> rests) {
    const std::size_t n = rests.size();
    std::vector<double> columns((n_inverse + 1) * n);
    for (std::size_t e = 0; e < n; ++e) {
      for (std::size_t k = 0; k < n_inverse; ++k) columns[k * n + e] = rests[e].dm_inv.data()[k];
      columns[n_inverse * n + e] = rest_measure(rests[e]);
    }
    numbers.upload(columns);
  }
  Columns rest() const {
    constexpr exec::Index inverse = n_inverse;
    return {numbers.data(), numbers.data() + numbers.size() / (inverse + 1) * inverse};
  }

  static constexpr std::size_t n_inverse = Columns::n_inverse;
  exec::Buffer<double> numbers;  // [n_inverse + 1, n]
};

}  // namespace bb
