// kappa of rows on an executor against StiffnessUpdate, over iterates, trials and steps.
#include <gtest/gtest.h>

#include <map>

#include "barriers/stiffness/registry.hpp"
#include "core/barrier/folded_barrier.hpp"
#include "core/math/error.hpp"
#include "core/resident/contact/contact_sums.hpp"
#include "core/resident/contact/resident_stiffness.hpp"
#include "core/terms/stiffness_update.hpp"
#include "tests/barriers/host_policy.hpp"
#include "tests/resident/contact_on_executor.hpp"
#include "tests/resident/tested_executor.hpp"

namespace bb::test::resident_stiffness_test {
namespace {

using resident::MatrixPart;
using resident::ResidentRows;
using resident::ResidentStiffness;
using resident::RowView;

/// A positive definite elastic matrix on random quadruples of vertices, as the CPU path and as kernels read it.
struct Elastic {
  explicit Elastic(const Scene& scene)
      : blocks(scene.n_vertices(), std::vector<std::uint8_t>(at(3 * scene.n_vertices()))) {
    const int n = scene.n_vertices();
    std::mt19937_64 rng(5);
    std::uniform_real_distribution<double> unit(-1, 1);
    const int n_elements = 3 * n;
    for (int e = 0; e < n_elements; ++e) {
      const int first = static_cast<int>(rng() % static_cast<unsigned>(n));
      for (int k = 0; k < 4; ++k) vertices.push_back((first + k * (1 + e % 3)) % n);
    }
    blocks.set_elements({Stencils{4, vertices}});
    blocks.set_contacts({});
    std::vector<double> hess;
    for (int e = 0; e < n_elements; ++e) {
      Mat<double, 12, 12> a = Mat<double, 12, 12>::NullaryExpr([&] { return 30 * unit(rng); });
      a = (a * a.transpose()).eval();
      double lower[n_lower_numbers(4)];
      store_lower_blocks(4, a, lower);
      hess.insert(hess.end(), std::begin(lower), std::end(lower));
    }
    blocks.clear();
    blocks.add_elements(0, hess);
    values = blocks.values();
    row_begin.push_back(0);
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) add_block(i, j);
      row_begin.push_back(static_cast<Index>(column.size()));
    }
    value.resize(static_cast<std::size_t>(resident::value_count(static_cast<Index>(column.size()))));
    for (std::size_t b = 0; b < full.size(); ++b) {
      for (int c = 0; c < 9; ++c) {
        value[static_cast<std::size_t>(resident::value_index(static_cast<Index>(b), c))] = full[b].data()[c];
      }
    }
  }
  void add_block(int i, int j) {
    const int pair[2] = {i, j};
    double sub[144];
    blocks.submatrix(values, pair, i == j ? 1 : 2, sub);
    const Mat3d block = Eigen::Map<const Mat<double, 12, 12>>(sub).block<3, 3>(0, i == j ? 0 : 3);
    if (block.isZero(0)) return;
    column.push_back(j);
    full.push_back(block);
  }

  std::vector<int> vertices;
  BlockSystem blocks;
  BlockSystem::Values values;
  std::vector<Index> row_begin;
  std::vector<int> column;
  std::vector<Mat3d> full;
  std::vector<double> value;
};

/// That matrix in the memory of an executor.
struct ElasticOnExecutor {
  ElasticOnExecutor(exec::Executor& executor, const Elastic& of)
      : row_begin(executor, "row begin"), column(executor, "column"), value(executor, "value") {
    row_begin.upload(of.row_begin), column.upload(of.column), value.upload(of.value);
  }
  MatrixPart part() const { return {row_begin.data(), column.data(), value.data()}; }
  exec::Buffer<Index> row_begin;
  exec::Buffer<int> column;
  exec::Buffer<double> value;
};

/// kappa of every pair, and the kind of its row.
using KappaOfPairs = std::map<std::pair<PairId, int>, double>;

KappaOfPairs kappa_of(const Rows& rows) {
  KappaOfPairs out;
  const auto add = [&](const auto& t, std::size_t r, int kind) { out[{t.pair[r], kind}] = t.kappa[r]; };
  for (std::size_t r = 0; r < rows.table.size(); ++r)
    add(rows.table, r, static_cast<int>(rows.table.kind[r]));
  for (std::size_t r = 0; r < rows.mollified.size(); ++r) add(rows.mollified, r, resident::mollified_kind);
  return out;
}

KappaOfPairs kappa_of(ResidentRows& rows) {
  KappaOfPairs out;
  const RowView v = rows.view();
  for (Index r = 0; r < v.n; ++r) out[{v.pair[r], v.kind[r]}] = v.kappa_of(r);
  return out;
}

double difference(const KappaOfPairs& a, const KappaOfPairs& b) {
  EXPECT_EQ(a.size(), b.size());
  EXPECT_GT(a.size(), 150U);
  double worst = 0;
  for (const auto& [key, kappa] : a) {
    const auto found = b.find(key);
    if (found == b.end()) return 1e300;
    EXPECT_GT(kappa, 0);
    if (std::isinf(kappa)) {  // M/d^2 of a pair that touches
      EXPECT_EQ(found->second, kappa);
      continue;
    }
    worst = std::max(worst, std::abs(found->second - kappa) / kappa);
  }
  return worst;
}

struct Policy {
  const char* mass_term;
  bool elastic;
  const char* refresh;
  double gap_floor;
  const char* derivative;
};
constexpr Policy policies[] = {
    {"paper", true, "per_iteration", 1e-3, "dropped"}, {"paper", false, "per_iteration", 0.2, "dropped"},
    {"inertia", true, "per_iteration", 0, "dropped"},  {"scaled", true, "per_step", 0.1, "dropped"},
    {"none", true, "per_step", 0, "dropped"},          {"paper", true, "per_step", 0, "included"},
    {"scaled", false, "per_step", 0, "included"},
};

/// begin step, iterate, rejected trial, accepted trial, iterate, next step: the same on both paths.
void follow(const Policy& p, exec::Order order, double& worst, std::string& bytes, Index& n_new,
            int& n_changed) {
  const Scene scene = full_scene(3);
  const Elastic elastic(scene);
  PolicyConfig config;
  config.name = "elasticity_inclusive";
  config.scale = 1.7;
  config.parameters.emplace("mass_term", p.mass_term);
  config.parameters["elastic_term"] = p.elastic;
  config.parameters["refresh"] = p.refresh;
  config.parameters["gap_floor"] = p.gap_floor;
  config.parameters["derivative"] = p.derivative;
  const auto policy = make_policy(config);
  StiffnessUpdate update(*policy, scene.mass);
  update.set_time({0.01, 1});

  TestedExecutor executor(order);
  const ElasticOnExecutor there(executor, elastic);
  ResidentStiffness stiffness(executor, *policy, scene.mass);
  stiffness.set_time({0.01, 1});

  ContactSystem contacts(scene, {});
  const Positions x[] = {shaken(scene), random_motion(scene.x0, 0.02, 7), random_motion(scene.x0, 0.012, 8)};
  Rows state = rows_at(contacts, x[0]);
  OnExecutor on(executor, scene, x[0], resident::columns_of(*policy));
  ResidentRows trial(executor, resident::columns_of(*policy));
  const auto refresh = [&] {
    const double change = update.refresh(state.table, state.mollified, elastic.blocks, elastic.values);
    stiffness.refresh(on.rows, there.part());
    const double resident_change = stiffness.change();
    if (std::isinf(change)) {
      EXPECT_EQ(resident_change, change);
    } else {
      EXPECT_NEAR(resident_change, change, 1e-10 * (1 + change));
    }
    n_changed += change > 0 && !std::isinf(change);
    worst = std::max(worst, difference(kappa_of(state), kappa_of(on.rows)));
    bytes += bytes_of(on.rows);
  };
  const auto try_at = [&](const Positions& y) {
    Rows rows = rows_at(contacts, y);
    update.freeze(rows.table, rows.mollified, elastic.blocks, elastic.values);
    on.find(scene, y, trial);
    stiffness.freeze(trial, on.rows, there.part());
    worst = std::max(worst, difference(kappa_of(rows), kappa_of(trial)));
    bytes += bytes_of(trial);
    return rows;
  };
  for (int step = 0; step < 2; ++step) {
    update.begin_step();
    stiffness.begin_step();
    refresh();
    const Index before = on.rows.size();
    try_at(x[1]);
    state = try_at(x[2]);
    on.rows.swap(trial);
    update.keep(state.table, state.mollified);
    stiffness.keep(on.rows);
    n_new += std::abs(on.rows.size() - before);
    refresh();
  }
}

TEST(ResidentStiffness, FollowsTheStiffnessOfTheCpuPathThroughTwoSteps) {
  int n_changed = 0;
  for (const Policy& p : policies) {
    double worst = 0;
    std::string bytes;
    Index n_new = 0;
    follow(p, exec::Order::threads, worst, bytes, n_new, n_changed);
    EXPECT_LT(worst, 1e-10) << p.mass_term << ' ' << p.refresh << ' ' << p.derivative;
    EXPECT_GT(n_new, 0);
    RecordProperty(std::string(p.mass_term) + p.refresh + p.derivative,
                   std::to_string(worst * 1e16) + "e-16");
  }
  EXPECT_GE(n_changed, 3);
}

TEST(ResidentStiffness, GivesTheSameBitsInAnyOrder) {
  for (const Policy& p : {policies[0], policies[3], policies[5]}) {
    std::string reference;
    for (const exec::Order order : {exec::Order::threads, exec::Order::reverse, exec::Order::shuffled}) {
      double worst = 0;
      std::string bytes;
      Index n_new = 0;
      int n_changed = 0;
      follow(p, order, worst, bytes, n_new, n_changed);
      if (reference.empty()) reference = bytes;
      EXPECT_TRUE(bytes == reference) << p.refresh;
    }
  }
}

TEST(ResidentStiffness, ReadsTheMatrixBlockByBlock) {
  const Scene scene = full_scene(1);
  const Elastic elastic(scene);
  TestedExecutor executor;
  PolicyConfig config{"elasticity_inclusive", 1, {}};
  config.parameters.emplace("mass_term", "none");
  const auto policy = make_policy(config);
  OnExecutor on(executor, scene, shaken(scene), resident::columns_of(*policy));
  const ElasticOnExecutor there(executor, elastic);
  ResidentStiffness stiffness(executor, *policy, scene.mass);
  stiffness.refresh(on.rows, there.part());
  const RowView v = on.rows.view();
  int n_coupled = 0;
  for (Index r = 0; r < v.n; ++r) {
    long double sum = 0, w_sq = 0;
    for (int i = 0; i < 4; ++i) {
      if (!v.is_free(r, i)) continue;
      const double wi = v.weight[i * v.n + r];
      w_sq += static_cast<long double>(wi) * wi;
      for (int j = 0; j < 4; ++j) {
        if (!v.is_free(r, j)) continue;
        const int a = v.vertex[i * v.n + r], b = v.vertex[j * v.n + r];
        for (Index k = elastic.row_begin[at(a)]; k < elastic.row_begin[at(a) + 1]; ++k) {
          if (elastic.column[static_cast<std::size_t>(k)] != b) continue;
          const Mat3d& h = elastic.full[static_cast<std::size_t>(k)];
          sum +=
              static_cast<long double>(wi) * v.weight[j * v.n + r] * v.normal_of(r).dot(h * v.normal_of(r));
          n_coupled += a != b;
        }
      }
    }
    const double expected = static_cast<double>(sum / w_sq);
    EXPECT_NEAR(v.kappa[r], expected, 1e-11 * expected);
  }
  EXPECT_GT(n_coupled, 100);
}

TEST(StepEndGaps, ListsPairsOfTwoStepEndsWhoseGapShrank) {
  const Scene scene = full_scene(5);
  TestedExecutor executor(exec::Order::shuffled);
  OnExecutor on(executor, scene, scene.x0);
  resident::StepEndGaps gaps(executor);
  EXPECT_TRUE(gaps.end_step(on.rows, 1e-6).empty());
  std::map<Key, double> before;
  RowView v = on.rows.view();
  for (Index r = 0; r < v.n; ++r) before[v.pair[r]] = v.d[r];
  on.find(scene, random_motion(scene.x0, 0.02, 3), on.rows);
  v = on.rows.view();
  std::vector<StiffnessPolicy::PairEnd> expected;
  for (Index r = 0; r < v.n; ++r) {
    const auto found = before.find(v.pair[r]);
    if (found != before.end() && v.d[r] < found->second)
      expected.push_back({v.d[r], found->second, 1e-6 * v.d_hat[r]});
  }
  const auto listed = gaps.end_step(on.rows, 1e-6);
  ASSERT_GT(expected.size(), 50U);
  ASSERT_LT(expected.size(), static_cast<std::size_t>(v.n) - 20);
  ASSERT_EQ(listed.size(), expected.size());
  for (std::size_t i = 0; i < listed.size(); ++i) {
    EXPECT_EQ(listed[i].gap, expected[i].gap);
    EXPECT_EQ(listed[i].gap_before, expected[i].gap_before);
    EXPECT_EQ(listed[i].park, expected[i].park);
  }
}

TEST(ResidentStiffness, RefusesAPolicyWithoutKernelByItsName) {
  try {
    resident::require_kernel(HostPolicy(), "/formulation/stiffness_policy/name");
    FAIL() << "not refused";
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.violations()[0].where, "/formulation/stiffness_policy/name");
    EXPECT_EQ(error.violations()[0].found, "host_only");
  }
  const Scene scene = full_scene(3);
  TestedExecutor executor;
  EXPECT_THROW(ResidentStiffness(executor, HostPolicy(), scene.mass), ConfigError);
  const auto fixed = make_policy({"fixed", 1, {{"kappa_N_per_m", 3.0}}});  // one kappa needs no kernel
  EXPECT_NO_THROW(ResidentStiffness(executor, *fixed, scene.mass));
}

}  // namespace
}  // namespace bb::test::resident_stiffness_test
