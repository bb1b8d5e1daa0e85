// strain_limit and svd: singular values and the barrier on them.
#include <limits>

#include "core/energy/strain_limit.hpp"
#include "core/math/svd.hpp"
#include "experiments/eval/barrier_field.hpp"
#include "experiments/eval/kinds.hpp"

namespace bb::eval {
namespace {

/// Energy of each singular value and its derivatives, by the density that the pipeline assembles.
template <class T>
struct LimitTerms {
  std::vector<double> energy, first, second;
  bool beyond = false;
};

template <class T, int N>
StrainShape<T, N> shape_at(const BarrierFunction& barrier, const Vec<T, N>& sigma,
                           const StrainBand<T>& band) {
  StrainShape<T, N> out;
  for (int k = 0; k < N; ++k) {
    const ShapeTerms<T> terms = barrier.eval(strain_gap(sigma[k], band), band.width);
    out.b[k] = terms.b;
    out.db[k] = terms.db;
    out.d2b[k] = terms.d2b;
  }
  return out;
}

template <class T>
LimitTerms<T> limit_terms(const BarrierFunction& barrier, const std::vector<double>& sigma,
                          const StrainBand<T>& band) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  LimitTerms<T> out;
  for (double value : sigma) {
    const T s = static_cast<T>(value);
    if (!(strain_gap(s, band) > T(0))) {
      out.beyond = true;
      for (auto* list : {&out.energy, &out.first, &out.second}) list->push_back(nan);
      continue;
    }
    const Vec<T, 2> both(s, s);  // the density is a sum over two: each term once
    const Density2<T> density =
        strain_limit_density<T, 2>(both, band, shape_at<T, 2>(barrier, both, band), T(1));
    out.energy.push_back(static_cast<double>(density.psi / T(2)));
    out.first.push_back(static_cast<double>(density.dpsi[0]));
    out.second.push_back(static_cast<double>(density.d2psi(0, 0)));
  }
  return out;
}

template <class T>
void add_terms(const LimitTerms<T>& terms, Answer& a) {
  a.list("E", terms.energy);
  a.list("dE", terms.first);
  a.list("d2E", terms.second);
  if (terms.beyond) a.status("beyond_limit");
}

/// Stretches of F, the absolute values of its singular values, and PK1 where all are below the limit.
template <class T, int N>
struct LimitOfF {
  std::vector<double> stretches;
  Mat<T, 3, N> pk1;

  LimitOfF(const BarrierFunction& barrier, const Mat<T, 3, N>& f, const StrainBand<T>& band) {
    const Svd<T, 3, N> svd = signed_svd(f);
    const Vec<T, N> sizes = svd.sigma.cwiseAbs();
    for (int k = 0; k < N; ++k) stretches.push_back(static_cast<double>(sizes[k]));
    if (!(strain_gap(sizes[0], band) > T(0))) return;
    const Density<T, N> density =
        strain_limit_density<T, N>(svd.sigma, band, shape_at<T, N>(barrier, sizes, band), T(1));
    pk1 = isotropic_terms<T, 3, N>(svd, density, Projection::none).pk1;
  }
};

template <class T, int N>
void answer_of_f(const BarrierFunction& barrier, const MatX<double>& f, const StrainBand<T>& band,
                 Answer& a) {
  const LimitOfF<T, N> of_f(barrier, Mat<T, 3, N>(f.cast<T>()), band);
  const LimitTerms<T> terms = limit_terms(barrier, of_f.stretches, band);
  add_terms(terms, a);
  if (terms.beyond) {
    a.null("PK1");
  } else {
    a.matrix("PK1", of_f.pk1);
  }
}

template <class T, int M, int N>
Answer svd_answer(const Svd<T, M, N>& svd) {
  Answer a;
  a.matrix("U", svd.U);
  a.vector("sigma", svd.sigma);
  a.matrix("V", svd.V);
  return a;
}

}  // namespace

template <class T>
Answer answer::strain_limit(Query& q) {
  const BarrierFunction barrier{shape_field(q), Argument::gap};
  const StrainBand<T> band{static_cast<T>(q.number("onset", kNonNegative)),
                           static_cast<T>(q.number("width", kPositive))};
  const bool from_f = q.has("F");
  const bool from_sigma = q.has("sigma");
  if (from_f && from_sigma) q.complain("sigma", "sigma and F", "one of the two");
  if (!from_f && !from_sigma) q.complain("sigma", "neither /sigma nor /F", "one of the two is required");
  const MatX<double> f = from_f ? q.rows("F", 3, -1) : MatX<double>::Zero(3, 2);
  if (!q.wrong() && f.cols() != 2 && f.cols() != 3) {
    q.complain("F", "3x" + std::to_string(f.cols()), "3x2 of a triangle, or 3x3 of a tetrahedron");
  }
  const std::vector<double> sigma = from_sigma ? q.list("sigma", -1, kFinite) : std::vector<double>();
  q.finish();

  Answer a;
  if (from_f && f.cols() == 2) answer_of_f<T, 2>(barrier, f, band, a);
  if (from_f && f.cols() == 3) answer_of_f<T, 3>(barrier, f, band, a);
  if (from_sigma) add_terms(limit_terms(barrier, sigma, band), a);
  return a;
}

template <class T>
Answer answer::svd(Query& q) {
  const MatX<double> f = q.rows("F", -1, -1);
  const bool known = (f.cols() == 2 && (f.rows() == 2 || f.rows() == 3)) || (f.cols() == 3 && f.rows() == 3);
  if (!q.wrong() && !known) {
    q.complain("F", std::to_string(f.rows()) + "x" + std::to_string(f.cols()), "2x2, 3x2 or 3x3");
  }
  q.finish();
  if (f.cols() == 3) return svd_answer<T, 3, 3>(svd_3x3<T>(f.cast<T>()));
  if (f.rows() == 3) return svd_answer<T, 3, 2>(svd_3x2<T>(f.cast<T>()));
  return svd_answer<T, 2, 2>(svd_2x2<T>(f.cast<T>()));
}

BB_EVAL_KIND(strain_limit);
BB_EVAL_KIND(svd);

}  // namespace bb::eval
