// (d_hat - d)^2 * (exp(1 - d / d_hat) + cosh(1 - d / d_hat) + atan(1 - d / d_hat)) + (d_hat - d)^(5 / 2) / d_hat^(1 / 2)
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
  static constexpr bool infinite_at_zero = 0;

  template <class T>
  BB_HD static bb::ShapeTerms<T> eval(T d, T d_hat) {
    if (d >= d_hat) return {T(0), T(0), T(0)};
    if (d == T(0)) return {d_hat * d_hat * T(6.0467606266717375), d_hat * T(-16.98700427544632), T(35.17881580502915)};
    const bb::shapes::NormalizedGap<T> gap(d, d_hat);
    return scalar_terms(gap, d_hat, T(0));
  }
  /// As built-in shapes have it where it takes nothing but + - * / and the logarithm: then four rows at a time.
  template <class T>
  BB_HD static bb::ShapeTerms<T> scalar_terms(const bb::shapes::NormalizedGap<T>& gap, T d_hat, [[maybe_unused]] T l) {
    using std::cos, std::cosh, std::pow, std::sin, std::sinh, std::sqrt, std::tan, std::tanh;
    [[maybe_unused]] const T u = gap.u, e = gap.e;
    const T c0 = (e * e);
    const T c1 = bb::elementary::atan2(e, T(1.0));
    const T c2 = std::cosh(e);
    const T c3 = bb::elementary::exp(e);
    const T c4 = c2 + c3;
    const T c5 = c1 + c4;
    const T c6 = T(2.0) * e;
    const T c7 = c0 + T(1.0);
    const T c8 = c3 + std::sinh(e) + (T(1.0) / c7);
    return {d_hat * d_hat * (c0 * c5 + pow(e, (T(5.0) / T(2.0)))), d_hat * (-c0 * c8 - c5 * c6 + ((T(-5.0) / T(2.0))) * (pow(e, (T(3.0) / T(2.0))))), T(c0 * (c4 - c6 / ((c7 * c7))) + T(2.0) * c1 + T(2.0) * c2 + T(2.0) * c3 + T(4.0) * c8 * e + (T(15.0) / T(4.0)) * (sqrt(e)))};
  }
};

extern "C" __global__ void __launch_bounds__(bb::exec::block_threads)
    barrierbench_shape(bb::exec::Index n, const __grid_constant__ bb::exec::EvaluateGivenShape f) {
  const auto i = static_cast<bb::exec::Index>(blockIdx.x) * bb::exec::block_threads + threadIdx.x;
  if (i < n) bb::exec::EvaluateShape<Formula>{f.rows, f.argument}(i);
}
