#include "core/energy/element_lanes.hpp"

#include <type_traits>

#include "core/math/lanes.hpp"

namespace bb {
namespace {

using FourNumbers = VectorOf<double, 4>::type;

/// Four numbers of four elements: rows become columns. Row by row: an array of vectors would be copied through memory.
void store_four(const double (*numbers)[4], std::size_t stride, double* to) {
  const FourNumbers row0 = load_lanes<4>(numbers[0]).v, row1 = load_lanes<4>(numbers[1]).v,
                    row2 = load_lanes<4>(numbers[2]).v, row3 = load_lanes<4>(numbers[3]).v;
  const FourNumbers even_low = __builtin_shufflevector(row0, row1, 0, 4, 2, 6),
                    odd_low = __builtin_shufflevector(row0, row1, 1, 5, 3, 7),
                    even_high = __builtin_shufflevector(row2, row3, 0, 4, 2, 6),
                    odd_high = __builtin_shufflevector(row2, row3, 1, 5, 3, 7);
  const auto store = [&](std::size_t lane, const FourNumbers& column) {
    store_lanes(Lanes<double, 4>(column), to + stride * lane);
  };
  store(0, __builtin_shufflevector(even_low, even_high, 0, 1, 4, 5));
  store(1, __builtin_shufflevector(odd_low, odd_high, 0, 1, 4, 5));
  store(2, __builtin_shufflevector(even_low, even_high, 2, 3, 6, 7));
  store(3, __builtin_shufflevector(odd_low, odd_high, 2, 3, 6, 7));
}

}  // namespace

template <class T>
void store_by_element(const T (*numbers)[4], std::size_t n, std::size_t stride, double* to) {
  std::size_t k = 0;
  if constexpr (std::is_same_v<T, double>) {
    for (; k + 4 <= n; k += 4) store_four(numbers + k, stride, to + k);
  }
  for (; k < n; ++k) {
    for (std::size_t lane = 0; lane < 4; ++lane) to[stride * lane + k] = numbers[k][lane];
  }
}

template void store_by_element(const float (*)[4], std::size_t, std::size_t, double*);
template void store_by_element(const double (*)[4], std::size_t, std::size_t, double*);

}  // namespace bb
