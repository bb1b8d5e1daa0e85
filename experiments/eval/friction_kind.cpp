// friction: value, gradient and Hessian of the friction of one contact.
#include "core/energy/friction.hpp"
#include "core/energy/friction_law.hpp"
#include "experiments/eval/any_scale.hpp"
#include "experiments/eval/kinds.hpp"
#include "experiments/eval/pair_field.hpp"

namespace bb::eval {

template <class T>
Answer answer::friction(Query& q) {
  const std::string law = q.choice("law", friction_law_names());
  const T mu = static_cast<T>(q.number("mu", kNonNegative));
  const T load = static_cast<T>(q.number("load", kNonNegative));
  const T eps = static_cast<T>(q.number("eps", kPositive));
  return with_pair(q, [&]<PairKind K>(PairTag<K>) {
    constexpr int n = pair_points(K);
    const Mat<T, 3, n> lagged = q.points<T>("points_lagged", n), start = q.points<T>("points_start", n),
                       end = q.points<T>("points_end", n);
    const Closest<T, n> closest = closest_at_any_scale<K, T>(lagged).closest;
    if (!q.wrong() && !(closest.d > 0)) {
      q.complain("points_lagged", "a pair that touches", "a pair with a gap, whose normal is known");
    }
    q.finish();

    const Vec<T, 3> normal = closest.r / closest.d;
    const Vec<T, 3> slide = slide_of<T>((end - start) * closest.weights, normal);
    const T y = slide.norm();
    const FrictionProfile<T> profile = friction_laws_in<T>().require(law, "/law").eval(y, eps);
    const auto terms =
        motion_in_points<T, n>(friction_terms<T>(slide, y, normal, mu * load, profile), closest.weights);
    Answer a;
    a.number("slide", static_cast<double>(y));
    a.number("energy", static_cast<double>(terms.energy));
    a.vector("gradient", terms.grad);
    a.matrix("hessian", terms.hess);
    a.matrix("hessian_psd", terms.hess);  // convex
    return a;
  });
}

BB_EVAL_KIND(friction);

}  // namespace bb::eval
