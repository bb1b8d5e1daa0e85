// A parameter of a stiffness policy is named once, in the struct of the policy: config, help, schema, the resolved config
// that a record keeps, and the policy of a run have it from there.
#include <optional>

#include "barriers/stiffness/policy_entry.hpp"
#include "experiments/config/config_list.hpp"
#include "tests/config/config_text.hpp"

namespace bb::policy_parameter_test {
namespace {

/// kappa = stiffness per gap over the gap, with one parameter and nothing else.
struct Hyperbolic {
  double force = 2;  // N
  Refresh refresh = Refresh::per_iteration;
  template <class List>
  static void describe(List& list) {
    list.positive("force_N", &Hyperbolic::force, "N", "kappa times the gap");
  }
  template <class Refuse>
  void check(Refuse& refuse) const {
    if (force > 100) refuse("force_N", force, "at most 100");
  }
  bool needs_hessian() const { return false; }
  bool has_potential() const { return false; }
  template <class T>
  T contact_kappa(const ContactSums<T>&, T d, T, const StiffnessTime&) const {
    return T(force) / d;
  }
  template <class T>
  KappaPartsOf<T> contact_parts(const ContactSums<T>&, T, const StiffnessTime&) const {
    return {};
  }
};
const bool registered = [] {
  stiffness_policies().add(*policy_entry<Hyperbolic>("hyperbolic", "for this test", PolicyUse::contact),
                           "test");
  return true;
}();

using test::json;

json with_policy(const json& policy) {
  json config = test::hang_config();
  config["formulation"] = {{"shape", "cubic"}, {"argument", "gap"}, {"stiffness_policy", policy}};
  config["matching"] = {{"rule", "as_given"}};
  config["strain_limit"] = {{"enabled", false}};
  return config;
}

/// The row of a list of settings at section/stiffness_policy/name; null where there is none.
std::optional<Parameter> row_of(const char* section, const std::string& name) {
  std::vector<Parameter> rows = config_list().rows;
  for (const char* key : {section, "stiffness_policy"}) {
    const Parameter* found = find_named(rows, key);
    if (found == nullptr) return std::nullopt;
    rows = std::vector<Parameter>(found->rule.list(json::object()).rows);
  }
  const Parameter* found = find_named(rows, name);
  return found ? std::optional<Parameter>(*found) : std::nullopt;
}

TEST(PolicyParameter, IsInHelpConfigRecordAndPolicyFromOneLine) {
  ASSERT_TRUE(registered);
  const std::optional<Parameter> row = row_of("formulation", "force_N");
  ASSERT_TRUE(row.has_value());
  EXPECT_EQ(row->rule.unit, "N");
  EXPECT_EQ(row->doc, "hyperbolic: kappa times the gap");

  const RunConfig plain = test::parsed(with_policy({{"name", "hyperbolic"}}));
  EXPECT_EQ(json::parse(resolved_json(plain))["formulation"]["stiffness_policy"]["force_N"], 2);
  const RunConfig config = test::parsed(with_policy({{"name", "hyperbolic"}, {"force_N", 5}, {"scale", 3}}));
  EXPECT_EQ(json::parse(resolved_json(config))["formulation"]["stiffness_policy"]["force_N"], 5);

  const auto policy = make_policy(config.formulation.stiffness_policy);
  const int n_free = 1;
  const double weight[4] = {1}, normal[3] = {0, 0, 1}, mass[4] = {1}, d = 0.5, d_hat = 1;
  double kappa = 0;
  policy->fill({1, &n_free, weight, normal, &d, &d_hat, mass, nullptr, {}}, &kappa);
  EXPECT_EQ(kappa, 3 * 5 / 0.5);
}

TEST(PolicyParameter, IsCheckedWithItsPlaceAndUnit) {
  const auto places = [](const json& policy) {
    std::vector<std::string> out;
    for (const Violation& v : test::violations_of(with_policy(policy).dump())) out.push_back(v.where);
    return out;
  };
  const std::vector<std::string> expected{"a.json#/formulation/stiffness_policy/force_N"};
  EXPECT_EQ(places({{"name", "hyperbolic"}, {"force_N", -1}}), expected);
  EXPECT_EQ(places({{"name", "hyperbolic"}, {"force_N", 101}}), expected);  // the policy's own refusal
  EXPECT_EQ(places({{"name", "fixed"}, {"kappa_N_per_m", 3}, {"force_N", 1}}),
            expected);  // of another policy
}

/// What the built-in policies list for contacts and for strain limits stands in the config as they list it.
TEST(PolicyParameter, ThoseOfTheBuiltInPoliciesAreAllSettings) {
  int n = 0;
  const auto compare = [&n](const char* section, const auto& registry) {
    for (const StiffnessPolicyEntry& entry : registry) {
      for (const Parameter& parameter : entry.parameters) {
        const std::optional<Parameter> row = row_of(section, parameter.name);
        ASSERT_TRUE(row.has_value()) << section << " " << parameter.name;
        EXPECT_EQ(row->fallback, parameter.fallback) << parameter.name;
        EXPECT_NE(row->doc.find(entry.name), std::string::npos) << parameter.name;
        ++n;
      }
    }
  };
  compare("formulation", stiffness_policies());
  compare("strain_limit", limit_policies());
  EXPECT_GE(n, 15);
}

}  // namespace
}  // namespace bb::policy_parameter_test
