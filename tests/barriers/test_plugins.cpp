// Plugins: the worked examples and a copy of a built-in work; everything else is refused with
// file, found, allowed.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include "barriers/plugins.hpp"
#include "barriers/shapes/registry.hpp"
#include "barriers/stiffness/registry.hpp"
#include "core/base/parameters/registry.hpp"
#include "core/math/error.hpp"
#include "tests/barriers/barrier_cases.hpp"

namespace bb::test::plugins_test {
namespace {

std::string test_plugin(const char* name) { return fmt::format("{}/plugin_{}.so", BB_PLUGIN_DIR, name); }
std::string example(const char* name) { return fmt::format("{}/plugin_{}.so", BB_EXAMPLE_PLUGIN_DIR, name); }

/// Each file once per process: a second registration is a name clash by design.
void register_once(const std::string& file) {
  static std::vector<std::string> done;
  if (std::find(done.begin(), done.end(), file) == done.end()) register_plugin(file);
  done.push_back(file);
}

template <class T>
void expect_same_bits(const Shape& a, const Shape& b, ShapeBatch<T> call_a, ShapeBatch<T> call_b) {
  std::vector<T> d, d_hat;
  for (const double u : spaced_u(1e-6, 1e-6, 20)) {
    d_hat.push_back(T(1e-3) * T(1 + u));
    d.push_back(T(u) * d_hat.back());
  }
  d.push_back(T(1));
  d_hat.push_back(T(1));
  const std::size_t n = d.size();
  std::vector<T> out_a(3 * n), out_b(3 * n);
  call_a(a.self, n, d.data(), d_hat.data(), out_a.data(), &out_a[n], &out_a[2 * n]);
  call_b(b.self, n, d.data(), d_hat.data(), out_b.data(), &out_b[n], &out_b[2 * n]);
  EXPECT_GT(out_a[0], 0);
  EXPECT_EQ(std::memcmp(out_a.data(), out_b.data(), 3 * n * sizeof(T)), 0);
}

TEST(Plugins, CopyOfABuiltInGivesTheSameBits) {
  register_once(test_plugin("cubic_copy"));
  const Shape &copy = require_shape("cubic_copy"), &built_in = require_shape("cubic");
  EXPECT_NE(copy.batch_double, built_in.batch_double);
  EXPECT_EQ(copy.smoothness_at_d_hat, built_in.smoothness_at_d_hat);
  EXPECT_EQ(copy.infinite_at_zero, built_in.infinite_at_zero);
  expect_same_bits<double>(copy, built_in, copy.batch_double, built_in.batch_double);
  expect_same_bits<float>(copy, built_in, copy.batch_float, built_in.batch_float);
}

TEST(Plugins, ExampleShapeHasTheValuesOfItsFormula) {
  register_once(example("inverse_shape"));
  const BarrierFunction fn{require_shape("inverse"), Argument::gap};
  // (2 - 1)^3/1, -(3 + 1), 6 (1 + 1 + 1/3) with e = u = 1/2, r = 1: 6 + 6 + 2
  EXPECT_DOUBLE_EQ(fn.eval(1.0, 2.0).b, 1);
  EXPECT_DOUBLE_EQ(fn.eval(1.0, 2.0).db, -4);
  EXPECT_DOUBLE_EQ(fn.eval(1.0, 2.0).d2b, 14);
  const double h = 1e-6, d = 0.3;
  EXPECT_NEAR((fn.eval(d + h, 1.0).b - fn.eval(d - h, 1.0).b) / (2 * h), fn.eval(d, 1.0).db, 1e-7);
  EXPECT_NEAR((fn.eval(d + h, 1.0).db - fn.eval(d - h, 1.0).db) / (2 * h), fn.eval(d, 1.0).d2b, 1e-5);
}

TEST(Plugins, ExamplePolicyFillsKappa) {
  register_once(example("effective_mass_policy"));
  PolicyConfig config;
  config.name = "effective_mass";
  config.parameters.emplace("refresh", "per_step");
  config.scale = 10;
  const auto policy = make_policy(config);
  EXPECT_EQ(policy->name(), "effective_mass");
  EXPECT_EQ(policy->refresh(), Refresh::per_step);
  EXPECT_FALSE(policy->needs_hessian());

  // two bodies of 2 kg and 6 kg: m_eff = 12/8; one of 4 kg at a wall with weight 1/2: m_eff = 16
  const int n_free[] = {2, 1};
  const double weight[] = {1, -1, 0, 0, 0.5, 0, 0, 0}, mass[] = {2, 6, 0, 0, 4, 0, 0, 0};
  StiffnessBatch rows;
  rows.n = 2;
  rows.n_free = n_free;
  rows.weight = weight;
  rows.mass = mass;
  rows.time = {0.1, 0.25};
  double kappa[2] = {-1, -1};
  policy->fill(rows, kappa);
  EXPECT_NEAR(kappa[0], 10 * 1.5 / 2.5e-3, 1e-9);
  EXPECT_NEAR(kappa[1], 10 * 16 / 2.5e-3, 1e-9);
}

/// x'' = -x from x = 1, v = 0 with the force -x: (x - x_tilde)/(c h^2) = -x.
TEST(Plugins, ExampleIntegratorIntegratesAnOscillator) {
  register_once(example("theta_integrator"));
  const auto integrator = make_integrator("theta");
  EXPECT_TRUE(integrator->needs_acceleration());
  EXPECT_FALSE(integrator->quasi_static());
  History history;
  history.x = Positions::Constant(3, 2, 1.0);
  history.v = Positions::Zero(3, 2);
  history.a = -history.x;
  const double h = 1e-3;
  Prediction prediction;
  for (; history.steps < 1000; ++history.steps) {
    integrator->predict(history, h, prediction);
    const Positions x = prediction.x_tilde / (1 + prediction.c * h * h);
    Positions v, a;
    integrator->finish(history, h, prediction, x, v, a);
    history.x_prev = history.x;
    history.v_prev = history.v;
    history.x = x;
    history.v = v;
    history.a = a;
  }
  EXPECT_DOUBLE_EQ(prediction.c, 0.55 * 0.55);
  EXPECT_NEAR(history.x(1, 1), std::cos(1.0), 1e-4);
  EXPECT_NEAR(history.v(2, 0), -std::sin(1.0), 1e-4);
}

std::string refusal(const std::string& file) {
  try {
    register_plugin(file);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}
void expect_in(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << "no '" << part << "' in: " << text;
}

TEST(Plugins, UnreadableFileIsRefused) {
  const std::string absent = test_plugin("that_is_not_there");
  expect_in(refusal(absent), absent + ": found ");
  expect_in(refusal(absent), "allowed: a shared library: a readable file");

  const std::string text_file = test_plugin("not_a_library");
  std::ofstream(text_file) << "plain text\n";
  expect_in(refusal(text_file), text_file + ": found ");
  expect_in(refusal(text_file), "found no ELF header; allowed: a whole 64-bit ELF shared library");
}

TEST(Plugins, MissingSymbolAndOtherAbiAreRefused) {
  expect_in(refusal(test_plugin("no_symbol")), "found no symbol barrierbench_plugin");
  const std::string abi = refusal(test_plugin("other_abi"));
  expect_in(abi, test_plugin("other_abi") + ": found abi_version 2; allowed: abi_version 1");
}

TEST(Plugins, TakenNamesAreAllNamedAndNothingIsRegistered) {
  const std::size_t n_shapes = all_shapes().size();
  const std::string text = refusal(test_plugin("name_clash"));
  expect_in(text, test_plugin("name_clash") + ": found shape \"log\"");
  expect_in(text, "shape \"fresh_shape\"");  // given twice
  expect_in(text, "stiffness policy \"fixed\"");
  expect_in(text, "integrator \"bdf2\"");
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3) << text;
  EXPECT_EQ(all_shapes().size(), n_shapes);
  EXPECT_EQ(all_shapes().find("fresh_shape"), nullptr);

  register_once(test_plugin("cubic_copy"));
  expect_in(refusal(test_plugin("cubic_copy")), "found shape \"cubic_copy\"");
}

TEST(Plugins, EntriesWithoutNameOrCallAreAllNamed) {
  const std::string text = refusal(test_plugin("bad_entries"));
  expect_in(text, "shape \"half_a_shape\" with a NULL call");
  expect_in(text, "stiffness policy named \"\"");
  expect_in(text, "integrator named \"Theta\"");
  EXPECT_EQ(all_shapes().find("half_a_shape"), nullptr);
}

}  // namespace
}  // namespace bb::test::plugins_test
