// stiffness: kappa of one contact by a stiffness policy. A field that cannot touch the answer may
// be left out.
#include "barriers/stiffness/elasticity_inclusive.hpp"
#include "barriers/stiffness/policy_parameters.hpp"
#include "experiments/eval/kinds.hpp"

namespace bb::eval {
namespace {

/// Columns of one contact over its N free vertices.
struct ContactFields {
  std::vector<double> weights, normal, masses;
  MatX<double> hessian;
  double gap = 1, d_hat = 1;
};

/// Reads what is there; `needed` says which fields must be.
struct Needed {
  bool stencil, gap, d_hat, masses, hessian;
};

ContactFields contact_fields(Query& q, const Needed& needed) {
  ContactFields c;
  const auto wanted = [&q](const char* name, bool need) { return need || q.has(name); };
  int n = -1;
  if (wanted("weights", needed.stencil)) {
    c.weights = q.list("weights", -1, kFinite);
    n = static_cast<int>(c.weights.size());
    if (n > 4) q.complain("weights", std::to_string(n) + " numbers", "1 to 4 numbers, one a free vertex");
    bool any = false;
    for (double w : c.weights) any = any || w != 0;
    if (!any) q.complain("weights", "only zeros", "at least one number that is not 0");
  }
  if (wanted("normal", needed.stencil)) {
    c.normal = q.list("normal", 3, kFinite);
    if (c.normal[0] == 0 && c.normal[1] == 0 && c.normal[2] == 0) {
      q.complain("normal", "the zero vector", "a unit vector");
    }
  }
  if (wanted("gap", needed.gap)) c.gap = q.number("gap", kPositive);
  if (wanted("d_hat", needed.d_hat)) c.d_hat = q.number("d_hat", kPositive);
  if (wanted("masses", needed.masses)) c.masses = q.list("masses", n, kNonNegative);
  if (wanted("hessian", needed.hessian))
    c.hessian = q.rows("hessian", n < 0 ? -1 : 3 * n, n < 0 ? -1 : 3 * n);
  return c;
}

template <class T>
std::vector<T> rounded(const std::vector<double>& values) {
  return {values.begin(), values.end()};
}

template <class T>
Answer elasticity_inclusive(Query& q) {
  ParameterMap given;
  given["mass_term"] = q.choice("mass_term", {"paper", "inertia", "scaled", "none"});
  given["elastic_term"] = q.flag_or("elastic_term", true);
  const PolicyParameters<ElasticityInclusive> list(PolicyUse::contact);
  const ElasticityInclusive policy = list.unchecked(own_parameters(list.rows(), given, ""));
  const bool scaled = policy.mass_term == MassTerm::scaled;
  StiffnessTime time;
  if (scaled || policy.mass_term == MassTerm::inertia) {
    time.dt = q.number("dt", kPositive);
    time.c = q.number("c", kPositive);
  }
  const bool mass = policy.mass_term != MassTerm::none;
  const ContactFields c =
      contact_fields(q, {true, policy.depends_on_gap(), scaled, mass, policy.elastic_term});
  q.finish();

  const auto weights = rounded<T>(c.weights), normal = rounded<T>(c.normal), masses = rounded<T>(c.masses);
  const MatX<T> hessian = c.hessian.cast<T>();
  const int n = static_cast<int>(weights.size());
  Answer a;
  const ContactSums<T> sums = contact_sums(n, weights.data(), normal.data(), mass ? masses.data() : nullptr,
                                           ColumnMajor<T>{hessian.data(), 3 * n}, policy.elastic_term);
  a.number("kappa", static_cast<double>(
                        policy.contact_kappa(sums, static_cast<T>(c.gap), static_cast<T>(c.d_hat), time)));
  return a;
}

template <class T>
Answer fixed(Query& q) {
  PolicyConfig config;
  config.parameters["kappa_N_per_m"] = q.number("kappa", kPositive);
  contact_fields(q, {false, false, false, false, false});
  q.finish();
  StiffnessBatch one;
  one.n = 1;
  double kappa = 0;
  make_policy(config)->fill(one, &kappa);
  Answer a;
  a.number("kappa", static_cast<double>(static_cast<T>(kappa)));
  return a;
}

}  // namespace

template <class T>
Answer answer::stiffness(Query& q) {
  const std::string policy = q.choice("policy", {"fixed", "elasticity_inclusive", "ipc_adaptive"});
  if (policy == "ipc_adaptive") {
    throw ConfigError("/policy", "ipc_adaptive", "fixed or elasticity_inclusive: ipc_adaptive needs a scene");
  }
  if (q.wrong()) q.finish();  // which fields there are depends on the policy
  return policy == "fixed" ? fixed<T>(q) : elasticity_inclusive<T>(q);
}

BB_EVAL_KIND(stiffness);

}  // namespace bb::eval
