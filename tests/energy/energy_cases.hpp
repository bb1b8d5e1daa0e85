// What the energy tests share: points of stacked vectors, random rotations, and the loop over the registry
// of membrane models.
#pragma once

#include <random>
#include <string_view>

#include "core/energy/membrane_list.hpp"
#include "core/energy/terms.hpp"
#include "tests/oracle/dense.hpp"
#include "tests/oracle/differences.hpp"

namespace bb::test {

inline double relative_difference(const MatXd& a, const MatXd& b, double scale) {
  return (a - b).cwiseAbs().maxCoeff() / scale;
}

inline Mat3d random_rotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
  return q.normalized().toRotationMatrix();
}

/// The N points of a stacked vector, and back.
template <class T, int N>
struct Points {
  Vec<T, 3> x[N];
  template <class Stacked>
  explicit Points(const Stacked& stacked) {
    for (int i = 0; i < N; ++i) x[i] = stacked.template segment<3>(3 * i).template cast<T>();
  }
};

/// Calls f.operator()<Model>(name) for every line of registry.inc.
template <class F>
void for_each_model(const F& f) {
#define ENTRY(name, ...) f.template operator()<membrane::name>(#name);
#include "core/energy/registry.inc"
#undef ENTRY
}

}  // namespace bb::test
