// energy: value, gradient, exact and projected Hessian of one element.
#include "core/energy/hinge.hpp"
#include "core/energy/membrane_model.hpp"
#include "core/energy/spring.hpp"
#include "experiments/eval/kinds.hpp"

namespace bb::eval {
namespace {

template <class T, int N>
struct Points {
  Vec<T, 3> x[N];
  Points(Query& q, const char* name) {
    const Eigen::Matrix<T, 3, Eigen::Dynamic> columns = q.points<T>(name, N);
    for (int i = 0; i < N; ++i) x[i] = columns.col(i);
  }
};

template <class T, int N>
Answer element_answer(const ElementTerms<T, N>& exact, const ElementTerms<T, N>& psd) {
  Answer a;
  a.number("energy", static_cast<double>(exact.energy));
  a.vector("gradient", exact.grad);
  a.matrix("hessian", exact.hess);
  a.matrix("hessian_psd", psd.hess);
  return a;
}

/// The warp direction of a model that depends on one: `warp_axis`, x by default, as of a body of a scene. Others take the first edge
/// of the rest triangle as their frame, and no warp_axis.
template <class T>
Vec<T, 3> warp_of(Query& q, const MembraneModel<T>& model, const Vec<T, 3>& first_edge) {
  if (!model.anisotropic) {
    if (q.has("warp_axis")) {
      q.complain("warp_axis", "an axis",
                 "nothing: the model " + std::string(model.name) + " has no direction");
    }
    return first_edge;
  }
  Vec<T, 3> axis = Vec<T, 3>::UnitX();
  if (!q.has("warp_axis")) return axis;
  const std::vector<double> given = q.list("warp_axis", 3, kFinite);
  for (int k = 0; k < 3; ++k) axis[k] = static_cast<T>(given[static_cast<std::size_t>(k)]);
  if (!q.wrong() && std::abs(axis.norm() - 1) > T(1e-6))
    q.complain("warp_axis", "no unit vector", "a unit vector");
  return axis;
}

template <class T>
Answer membrane(Query& q, const MembraneModel<T>& model) {
  const Points<T, 3> rest(q, "rest"), x(q, "x");
  const T mu = static_cast<T>(q.number("lame_mu", kNonNegative));
  const T lambda = static_cast<T>(q.number("lame_lambda", kFinite));
  const Vec<T, 3> warp = warp_of<T>(q, model, rest.x[1] - rest.x[0]);
  const TriangleRest<T> triangle = triangle_rest<T>(rest.x, warp);
  const Vec<T, 3> normal = (rest.x[1] - rest.x[0]).cross(rest.x[2] - rest.x[0]);
  const T size = normal.norm(), cosine = size > T(0) ? warp.dot(normal) / (warp.norm() * size) : T(1);
  const bool usable = triangle.area > T(0) && triangle.dm_inv.allFinite();
  if (q.wrong()) {
    // complained of
  } else if (!(size > T(0)) || !normal.allFinite() || (!model.anisotropic && !usable)) {
    q.complain("rest", "a triangle without area", "three points that are not on one line");
  } else if (!usable || std::abs(cosine) > T(1) - T(1e-6)) {
    q.complain("warp_axis", "the normal of the triangle at rest",
               "an axis with a part in its plane (default: x)");
  }
  q.finish();
  return element_answer<T, 9>(model.terms(triangle, x.x, mu, lambda, Projection::none),
                              model.terms(triangle, x.x, mu, lambda, Projection::psd));
}

template <class T>
Answer spring(Query& q) {
  const Points<T, 2> rest(q, "rest"), x(q, "x");
  const T k = static_cast<T>(q.number("k", kNonNegative));
  q.finish();
  const T length = (rest.x[1] - rest.x[0]).norm();
  return element_answer<T, 6>(spring_terms<T>(x.x, k, length, Projection::none),
                              spring_terms<T>(x.x, k, length, Projection::psd));
}

/// The rest angle is a field of its own, so `rest` may be left out.
template <class T>
Answer hinge(Query& q) {
  if (q.has("rest")) Points<T, 4>(q, "rest");
  const Points<T, 4> x(q, "x");
  const T k = static_cast<T>(q.number("k", kNonNegative));
  const T angle = static_cast<T>(q.number("rest_angle", kFinite));
  q.finish();
  return element_answer<T, 12>(hinge_terms<T>(x.x, k, angle, Projection::none),
                               hinge_terms<T>(x.x, k, angle, Projection::psd));
}

}  // namespace

template <class T>
Answer answer::energy(Query& q) {
  std::vector<std::string> names = membrane_models<T>().names();
  names.insert(names.end(), {"spring", "hinge"});
  const std::string name = q.choice("model", names);
  if (q.wrong()) q.finish();  // which fields there are depends on the model
  if (name == "spring") return spring<T>(q);
  if (name == "hinge") return hinge<T>(q);
  return membrane<T>(q, *membrane_models<T>().find(name));
}

BB_EVAL_KIND(energy);

}  // namespace bb::eval
