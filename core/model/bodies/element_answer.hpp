// What one element of a part answers: energy and derivatives at given points.
#pragma once

#include <string>

#include "core/base/parameters/fields.hpp"
#include "core/energy/terms.hpp"

namespace bb {

struct ElementAnswer {
  double energy = 0;                     // J
  Eigen::VectorXd gradient;              // N
  Eigen::MatrixXd hessian, hessian_psd;  // N/m
  std::string status;                    // where derivatives are a choice; else empty
};

/// N points, each a row of the field `name`.
template <class T, int N>
struct FieldPoints {
  Vec<T, 3> x[N];
  FieldPoints(Fields& fields, const char* name) {
    const Eigen::Matrix<T, 3, Eigen::Dynamic> columns = fields.points<T>(name, N);
    for (int i = 0; i < N; ++i) x[i] = columns.col(i);
  }
};

/// exact: under Projection::none; psd: under Projection::psd.
template <class T, int N>
ElementAnswer element_answer(const ElementTerms<T, N>& exact, const ElementTerms<T, N>& psd) {
  return {static_cast<double>(exact.energy),
          exact.grad.template cast<double>(),
          exact.hess.template cast<double>(),
          psd.hess.template cast<double>(),
          {}};
}

/// The same, where derivatives may be a choice.
inline ElementAnswer cusp_answer(bool is_cusp, ElementAnswer answer) {
  if (is_cusp) answer.status = "cusp";
  return answer;
}

/// f.operator()<T>() in the scalar that the fields request.
template <class F>
ElementAnswer in_scalar_of(const Fields& fields, const F& f) {
  return fields.single() ? f.template operator()<float>() : f.template operator()<double>();
}

}  // namespace bb
