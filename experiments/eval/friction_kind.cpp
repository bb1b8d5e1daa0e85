// friction: value, gradient and Hessian of the friction of one contact.
#include <algorithm>

#include "core/energy/friction.hpp"
#include "core/energy/friction_law.hpp"
#include "experiments/eval/any_scale.hpp"
#include "experiments/eval/kinds.hpp"
#include "experiments/eval/pair_field.hpp"

namespace bb::eval {

/// A law with its numbers, and the largest force that it has, N.
template <class T>
struct AskedFriction {
  const FrictionLaw<T>& law;
  SlideScales<T> scales;
  T strength;
};

namespace {

template <class T>
AskedFriction<T> asked_law(Query& q) {
  const FrictionLaw<T>& law = friction_laws_in<T>().require(q.choice("law", friction_law_names()), "/law");
  const T mu = static_cast<T>(q.number("mu", kNonNegative));
  const T load = static_cast<T>(q.number("load", kNonNegative));
  const T eps = static_cast<T>(q.number("eps", kPositive));
  AskedFriction<T> out{law, {eps, T(1), 10 * eps}, mu * load};
  if (!law.two_coefficients) return out;
  const T most = static_cast<T>(q.number_or("mu_static", kNonNegative, static_cast<double>(mu)));
  out.scales.reach = static_cast<T>(q.number_or("reach", kPositive, static_cast<double>(10 * eps)));
  if (!q.wrong() && most < mu) q.complain("mu_static", "less than mu", "a number >= mu");
  if (!q.wrong() && !(out.scales.reach > eps)) q.complain("reach", "not above eps", "a number > eps");
  out.scales.kinetic = most > T(0) ? mu / most : T(1);
  out.strength = most * load;
  return out;
}

}  // namespace

template <class T>
Answer answer::friction(Query& q) {
  const AskedFriction<T> asked = asked_law<T>(q);
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
    FrictionProfile<T> profile = asked.law.eval(y, asked.scales);
    const auto in_points = [&] {
      return motion_in_points<T, n>(friction_terms<T>(slide, y, normal, asked.strength, profile),
                                    closest.weights);
    };
    const auto terms = in_points();
    profile.f2 = std::max(profile.f2, T(0));
    Answer a;
    a.number("slide", static_cast<double>(y));
    a.number("energy", static_cast<double>(terms.energy));
    a.vector("gradient", terms.grad);
    a.matrix("hessian", terms.hess);
    a.matrix("hessian_psd", in_points().hess);
    return a;
  });
}

BB_EVAL_KIND(friction);

}  // namespace bb::eval
