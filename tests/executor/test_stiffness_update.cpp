// kappa of rows over iterates, trials and steps: tables of the host and columns of an executor, in every order, against the policy's
// formula in long double and a memory by pairs.
#include <gtest/gtest.h>

#include "barriers/stiffness/registry.hpp"
#include "core/contact/executor/policy_kernels.hpp"
#include "core/math/error.hpp"
#include "core/terms/contact_stiffness.hpp"
#include "tests/barriers/host_policy.hpp"
#include "tests/executor/contact_on_executor.hpp"
#include "tests/executor/expected_stiffness.hpp"
#include "tests/executor/tested_executor.hpp"

namespace bb::test::stiffness_update_test {
namespace {

/// Begin of a step, iterate, rejected trial, accepted trial, iterate; twice. Rows: has refresh(time), try_at(x), accept(), state() and
/// trial() as RowSums.
template <class Form>
void follow(const Policy& p, Form& form, const Scene& scene, int& n_changed) {
  Expected expected(p);
  const Positions x[] = {random_motion(scene.x0, 0.02, 7), random_motion(scene.x0, 0.012, 8)};
  const auto refresh = [&] {
    const double change = form.refresh();
    const double wanted = expected.refresh(form.state());
    if (std::isinf(wanted)) {
      EXPECT_EQ(change, wanted);
    } else {
      EXPECT_NEAR(change, wanted, 1e-10 * (1 + wanted));
    }
    n_changed += wanted > 0 && !std::isinf(wanted);
  };
  for (const StiffnessTime& time : times) {
    form.begin_step(time);
    expected.begin_step(time);
    refresh();
    EXPECT_GT(form.state().size(), 150U);
    form.try_at(x[0]);
    expected.freeze(form.trial(), false);
    form.try_at(x[1]);
    expected.freeze(form.trial(), true);
    form.accept();
    refresh();
  }
  EXPECT_LT(expected.worst, 1e-12) << p.mass_term << ' ' << p.refresh << ' ' << p.derivative;
  EXPECT_GT(expected.n_new, 50);
}

/// Tables of the host, rows and mollified rows apart.
struct HostForm {
  HostForm(const Policy& p, exec::Order order, const Scene& of, const Elastic& h)
      : scene(of), elastic(h), executor(order), policy(p.make()), contacts(of, {}) {
    update.emplace(executor, *policy, scene.mass);
    rows = rows_at(contacts, shaken(scene));
    EXPECT_GT(rows.mollified.size(), 5U);
  }
  void begin_step(const StiffnessTime& time) {
    update->begin_step();
    update->set_time(time);
  }
  double refresh() { return update->refresh({rows.table, rows.mollified}, elastic.blocks, elastic.values); }
  void try_at(const Positions& x) {
    tried = rows_at(contacts, x);
    update->freeze({tried.table, tried.mollified}, {rows.table, rows.mollified}, elastic.blocks,
                   elastic.values);
  }
  void accept() {
    std::swap(rows, tried);
    update->keep({rows.table, rows.mollified});
  }
  std::vector<RowSums> state() const { return sums_of(rows, scene, elastic); }
  std::vector<RowSums> trial() const { return sums_of(tried, scene, elastic); }

  const Scene& scene;
  const Elastic& elastic;
  exec::HostExecutor executor;
  std::unique_ptr<StiffnessPolicy> policy;
  ContactSystem contacts;
  std::optional<ContactStiffness> update;
  Rows rows, tried;
};

/// Columns of an executor, all rows in one table.
struct ExecutorForm {
  ExecutorForm(const Policy& p, exec::Order order, const Scene& of, const Elastic& h)
      : scene(of),
        elastic(h),
        executor(order),
        policy(p.make()),
        there(executor, h),
        matrix(there.part()),
        mass(executor, "masses"),
        on(executor, of, shaken(of), exec::columns_of(*policy)),
        tried(executor, exec::columns_of(*policy)),
        update(executor, *policy) {
    mass.upload(scene.mass);
  }
  StiffnessUpdate::Compute kappa_of(ExecutorRows& rows) {
    return exec::KernelKappa{rows, executor, *policy, time, mass.data(), matrix};
  }
  void begin_step(const StiffnessTime& of) {
    update.begin_step();
    time = of;
  }
  double refresh() {
    const StiffnessRows rows[] = {on.rows.stiffness_rows()};
    update.refresh(rows, kappa_of(on.rows));
    bytes += bytes_of(on.rows);
    return update.change();
  }
  void try_at(const Positions& x) {
    on.find(scene, x, tried);
    const StiffnessRows trial[] = {tried.stiffness_rows()}, iterate[] = {on.rows.stiffness_rows()};
    update.freeze(trial, iterate, kappa_of(tried));
    bytes += bytes_of(tried);
  }
  void accept() {
    on.rows.swap(tried);
    const StiffnessRows rows[] = {on.rows.stiffness_rows()};
    update.keep(rows);
  }
  std::vector<RowSums> state() { return sums_of(on.rows, scene, elastic); }
  std::vector<RowSums> trial() { return sums_of(tried, scene, elastic); }

  const Scene& scene;
  const Elastic& elastic;
  TestedExecutor executor;
  std::unique_ptr<StiffnessPolicy> policy;
  ElasticOnExecutor there;
  MatrixPart matrix;
  exec::Buffer<double> mass;
  OnExecutor on;
  ExecutorRows tried;
  StiffnessUpdate update;
  StiffnessTime time;
  std::string bytes;
};

TEST(StiffnessUpdate, IsThatOfTheFormulaAndAMemoryThroughTwoSteps) {
  const Scene scene = full_scene(3);
  const Elastic elastic(scene);
  int n_changed = 0;
  for (const Policy& p : policies) {
    for (const exec::Order order : {exec::Order::threads, exec::Order::shuffled}) {
      HostForm tables(p, order, scene, elastic);
      follow(p, tables, scene, n_changed);
      ExecutorForm columns(p, order, scene, elastic);
      follow(p, columns, scene, n_changed);
    }
  }
  EXPECT_GE(n_changed, 12);
}

TEST(StiffnessUpdate, GivesTheSameBitsInAnyOrder) {
  const Scene scene = full_scene(3);
  const Elastic elastic(scene);
  for (const Policy& p : {policies[0], policies[3], policies[5]}) {
    std::string reference;
    for (const exec::Order order : {exec::Order::threads, exec::Order::reverse, exec::Order::shuffled}) {
      ExecutorForm columns(p, order, scene, elastic);
      int n_changed = 0;
      follow(p, columns, scene, n_changed);
      if (reference.empty()) reference = columns.bytes;
      EXPECT_TRUE(columns.bytes == reference) << p.refresh;
    }
  }
}

TEST(PolicyKernels, RefusesAPolicyWithoutKernelByItsName) {
  try {
    exec::require_kernel(HostPolicy(), "/formulation/stiffness_policy/name");
    FAIL() << "not refused";
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.violations()[0].where, "/formulation/stiffness_policy/name");
    EXPECT_EQ(error.violations()[0].found, "host_only");
  }
  const auto fixed = make_policy({"fixed", 1, {{"kappa_N_per_m", 3.0}}});  // one kappa needs no kernel
  EXPECT_NO_THROW(exec::require_kernel(*fixed, ""));
}

}  // namespace
}  // namespace bb::test::stiffness_update_test
