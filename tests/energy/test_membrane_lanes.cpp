// Four triangles side by side: every lane has the bits of its triangle taken alone, whatever its neighbours need.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <vector>

#include "core/energy/element_lanes.hpp"
#include "core/energy/membrane_lanes.hpp"
#include "core/energy/membrane_list.hpp"
#include "core/math/lower_blocks.hpp"
#include "tests/energy/energy_cases.hpp"

namespace bb::test::membrane_lanes_test {
namespace {

const Vec<double, 9> rest_state{{0, 0, 0.3, 1.1, 0.2, 0.1, -0.3, 0.7, 0.2}};

/// States that take other ways through the singular value decomposition and the projection.
const std::vector<Vec<double, 9>> states = {
    rest_state,
    Vec<double, 9>{{0.1, 0.2, 0.3, 1.2, -0.1, 0.6, -0.2, 0.5, 0.1}},  // sheared
    2.5 * rest_state,                                                 // stretched
    0.2 * rest_state,                                    // compressed: the exact Hessian is indefinite
    Vec<double, 9>{{0, 0, 0, 0.3, 0, 0, 0, 4, 0}},       // the second column of F is the longer one
    Vec<double, 9>{{0, 0, 0, 1, 2, 0.5, 0.5, 1, 0.25}},  // on a line
    Vec<double, 9>::Constant(0.4),                       // in one point
    Vec<double, 9>{{0, 0, 0, 1, 0, 0, 0, 1e-9, 0}},      // nearly on a line
};

/// As numbers compare, but two NaNs are the same.
template <class T>
void expect_same(T got, T one) {
  EXPECT_TRUE(got == one || (got != got && one != one)) << got << " " << one;
}

/// How many of the exact Hessians are indefinite.
template <class Model, class T>
int compare_abreast() {
  const Points<T, 3> rest_points(rest_state);
  const Vec<T, 3> warp = rest_points.x[1] - rest_points.x[0];
  const TriangleRest<T> rest = triangle_rest<T>(rest_points.x, warp);
  const int n = static_cast<int>(states.size());
  int negative = 0;
  for (int first = 0; first < n; ++first) {
    const auto points = [&](int lane) {
      return Points<T, 3>(states[static_cast<std::size_t>((first + lane) % n)]);
    };
    const auto mu = [](int lane) { return T(3 + lane); };
    TrianglesAbreast<T> triangles;
    for (int lane = 0; lane < membrane_lanes; ++lane) {
      triangles.set(lane, points(lane).x, rest, mu(lane), T(2));
    }
    T values[membrane_lanes];
    membrane_values_abreast<Model>(triangles, values);
    for (int lane = 0; lane < membrane_lanes; ++lane) {
      expect_same(values[lane], membrane_value<Model, 3, T>(rest, points(lane).x, mu(lane), T(2)));
    }
    T stretches[2][membrane_lanes];
    stretches_abreast(triangles, stretches);
    for (int lane = 0; lane < membrane_lanes; ++lane) {
      const auto sigma = svd_3x2(deformation_gradient<3>(rest, points(lane).x)).sigma;
      for (int k = 0; k < 2; ++k) expect_same(stretches[k][lane], sigma[k]);
    }
    for (const Projection projection : {Projection::none, Projection::psd, Projection::absolute}) {
      TermsAbreast<T, membrane_lanes, 3> got;
      membrane_terms_abreast<Model>(triangles, projection, got);
      for (int lane = 0; lane < membrane_lanes; ++lane) {
        SCOPED_TRACE(std::to_string((first + lane) % n));
        const auto one = membrane_terms<Model, 3, T>(rest, points(lane).x, mu(lane), T(2), projection);
        expect_same(got.energy[lane], one.energy);
        for (int k = 0; k < 9; ++k) expect_same(got.grad[k][lane], one.grad[k]);
        EXPECT_TRUE(projection == Projection::psd || one.hess.norm() > 0);  // all of it may be clamped away
        const auto* number = got.hess;
        for_each_lower_number(
            3, [&](int row, int column) { expect_same((*number++)[lane], one.hess(row, column)); });
        if (projection == Projection::none) {
          const Mat<double, 9, 9> exact = one.hess.template cast<double>();
          negative += project<double, 9>(exact, Projection::psd) != exact;
        }
      }
    }
  }
  return negative;
}

TEST(MembraneLanes, FourAbreastHaveTheBitsOfOneByOne) {
#define ENTRY(id, ...)                                       \
  {                                                          \
    SCOPED_TRACE(#id);                                       \
    EXPECT_GT((compare_abreast<membrane::id, double>()), 4); \
    EXPECT_GT((compare_abreast<membrane::id, float>()), 4);  \
  }
#include "core/energy/registry.inc"
#undef ENTRY
}

template <class T>
void expect_stored(std::size_t n) {
  std::vector<T> numbers(4 * n);
  for (std::size_t k = 0; k < numbers.size(); ++k) numbers[k] = static_cast<T>(k + 1);
  const std::size_t stride = n + 2;
  std::vector<double> to(4 * stride, -1);
  T rows[32][4];
  std::memcpy(rows, numbers.data(), numbers.size() * sizeof(T));
  store_by_element(rows, n, stride, to.data());
  for (std::size_t lane = 0; lane < 4; ++lane) {
    for (std::size_t k = 0; k < stride; ++k) {
      EXPECT_EQ(to[stride * lane + k], k < n ? static_cast<double>(4 * k + lane + 1) : -1.0) << n;
    }
  }
}

TEST(MembraneLanes, NumbersGoToTheirElements) {
  for (const std::size_t n : {1u, 3u, 4u, 9u, 16u, 31u}) expect_stored<double>(n), expect_stored<float>(n);
}

}  // namespace
}  // namespace bb::test::membrane_lanes_test
