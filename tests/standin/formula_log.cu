// -(d - d_hat)^2 * log(d / d_hat)
// Made by ./bench formula; not edited. e = 1 - u, u = d/d_hat, l = -ln u, r = 1/u.
// clang-format off
#include <cmath>
#include <limits>

#include "core/exec/cuda/device_block.cuh"
#include "core/math/atan2.hpp"
#include "core/math/exp.hpp"
#include "core/contact/executor/given_shape.hpp"
#include "core/contact/executor/shape_kernels.hpp"

static_assert(bb::exec::given_shape_layout == 0x8020284860687078, "the program was built from other sources: ./bench build");

struct Formula {
  static constexpr bool infinite_at_zero = 1;

  template <class T>
  BB_HD static bb::ShapeTerms<T> eval(T d, T d_hat) {
    if (d >= d_hat) return {T(0), T(0), T(0)};
    if (d == T(0)) return {d_hat * d_hat * T(std::numeric_limits<T>::infinity()), d_hat * T(-std::numeric_limits<T>::infinity()), T(std::numeric_limits<T>::infinity())};
    const bb::shapes::NormalizedGap<T> gap(d, d_hat);
    return terms(gap, d_hat, gap.minus_log());
  }
  /// As built-in shapes have it where it takes nothing but + - * / and the logarithm: then four rows at a time.
  template <class T>
  BB_HD static bb::ShapeTerms<T> terms(const bb::shapes::NormalizedGap<T>& gap, T d_hat, [[maybe_unused]] T l) {
    using std::cos, std::cosh, std::pow, std::sin, std::sinh, std::sqrt, std::tan, std::tanh;
    [[maybe_unused]] const T u = gap.u, e = gap.e;
    const T r = T(1.0) / u;
    const T c0 = (e * e);
    const T c1 = T(2.0) * l;
    const T c2 = e * r;
    return {d_hat * d_hat * (c0 * l), d_hat * (-e * (c1 + c2)), T(c0 * ((r * r)) + c1 + T(4.0) * c2)};
  }
};

extern "C" __global__ void __launch_bounds__(bb::exec::block_threads)
    barrierbench_shape(bb::exec::Index n, const __grid_constant__ bb::exec::EvaluateGivenShape f) {
  const auto i = static_cast<bb::exec::Index>(blockIdx.x) * bb::exec::block_threads + threadIdx.x;
  if (i < n) bb::exec::EvaluateShape<Formula>{f.rows, f.argument}(i);
}
