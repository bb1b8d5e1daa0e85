// What a stiffness update has to give: rows of both forms against the policy's formula in long double and a memory by pairs.
#pragma once

#include <map>

#include "barriers/stiffness/registry.hpp"
#include "core/contact/executor/policy_kernels.hpp"
#include "core/terms/contact_stiffness.hpp"
#include "tests/executor/contact_on_executor.hpp"
#include "tests/executor/tested_executor.hpp"

namespace bb::test::stiffness_update_test {

using exec::ExecutorRows;
using exec::MatrixPart;
using exec::RowView;

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
    value.resize(static_cast<std::size_t>(exec::value_count(static_cast<Index>(column.size()))));
    for (std::size_t b = 0; b < full.size(); ++b) {
      for (int c = 0; c < 9; ++c) {
        value[static_cast<std::size_t>(exec::value_index(static_cast<Index>(b), c))] = full[b].data()[c];
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

  /// The block of two vertices.
  Mat3d block(int i, int j) const {
    for (Index k = row_begin[at(i)]; k < row_begin[at(i) + 1]; ++k) {
      if (column[static_cast<std::size_t>(k)] == j) return full[static_cast<std::size_t>(k)];
    }
    return Mat3d::Zero();
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

struct Policy {
  const char* mass_term;
  bool elastic;
  const char* refresh;
  double gap_floor;
  const char* derivative;

  bool per_iteration() const { return std::string_view(refresh) == "per_iteration"; }
  bool has_potential() const { return std::string_view(derivative) == "included"; }
  std::unique_ptr<StiffnessPolicy> make() const {
    PolicyConfig config{"elasticity_inclusive", scale, {}};
    config.parameters.emplace("mass_term", mass_term);
    config.parameters["elastic_term"] = elastic;
    config.parameters["refresh"] = refresh;
    config.parameters["gap_floor"] = gap_floor;
    config.parameters["derivative"] = derivative;
    return make_policy(config);
  }
  static constexpr double scale = 1.7;
};
constexpr Policy policies[] = {
    {"paper", true, "per_iteration", 1e-3, "dropped"}, {"paper", false, "per_iteration", 0.2, "dropped"},
    {"inertia", true, "per_iteration", 0, "dropped"},  {"scaled", true, "per_step", 0.1, "dropped"},
    {"none", true, "per_step", 0, "dropped"},          {"paper", true, "per_step", 0, "included"},
    {"scaled", false, "per_step", 0, "included"},
};
constexpr StiffnessTime times[] = {{0.01, 1}, {0.005, 0.5}};  // of two steps

/// What the formula of a policy reads of a row, and the kappa that the row was given.
struct RowSums {
  PairId pair;
  long double mass, elastic;  // w^T M w and w^T H w over w^T w
  double d, d_hat, kappa;
};

RowSums sums_of(PairId pair, std::span<const int> vertex, std::span<const double> weight, const Vec3d& normal,
                const Scene& scene, const Elastic& h) {
  RowSums out{pair, 0, 0, 0, 0, 0};
  long double w_sq = 0;
  for (std::size_t i = 0; i < vertex.size(); ++i) {
    const long double wi = weight[i];
    w_sq += wi * wi;
    out.mass += wi * wi * scene.mass[at(vertex[i])];
    for (std::size_t j = 0; j < vertex.size(); ++j)
      out.elastic +=
          wi * weight[j] * static_cast<long double>(normal.dot(h.block(vertex[i], vertex[j]) * normal));
  }
  out.mass /= w_sq, out.elastic /= w_sq;
  return out;
}

inline std::vector<RowSums> sums_of(const Rows& rows, const Scene& scene, const Elastic& h) {
  std::vector<RowSums> out;
  const auto add = [&](const auto& t, const std::vector<int>& vertex) {
    for (std::size_t r = 0; r < t.size(); ++r) {
      const auto n = static_cast<std::size_t>(t.n_free[r]);
      RowSums row = sums_of(t.pair[r], {&vertex[4 * r], n}, {&t.weight[4 * r], n},
                            Vec3d::Map(&t.normal[3 * r]), scene, h);
      row.d = t.d[r], row.d_hat = t.d_hat[r], row.kappa = t.kappa[r];
      out.push_back(row);
    }
  };
  add(rows.table, rows.table.vertex);
  add(rows.mollified, rows.mollified.free_vertex);
  return out;
}

inline std::vector<RowSums> sums_of(ExecutorRows& rows, const Scene& scene, const Elastic& h) {
  std::vector<RowSums> out;
  const RowView v = rows.view();
  for (Index r = 0; r < v.n; ++r) {
    std::vector<int> vertex;
    std::vector<double> weight;
    for (int k = 0; k < 4; ++k) {
      if (v.is_free(r, k)) vertex.push_back(v.vertex[k * v.n + r]), weight.push_back(v.weight[k * v.n + r]);
    }
    RowSums row = sums_of(v.pair[r], vertex, weight, v.normal_of(r), scene, h);
    row.d = v.d[r], row.d_hat = v.d_hat[r], row.kappa = v.kappa_of(r);
    out.push_back(row);
  }
  return out;
}

/// The rule in long double, pair by pair.
class Expected {
 public:
  explicit Expected(const Policy& policy) : policy_(policy) {}
  void begin_step(const StiffnessTime& time) {
    time_ = time;
    known_.clear();
  }
  /// The largest change.
  double refresh(const std::vector<RowSums>& rows) {
    double change = 0;
    if (policy_.per_iteration()) known_.clear();
    std::map<PairId, long double> now;
    for (const RowSums& row : rows) {
      const long double kappa = expect(row, row.d, true);
      now[row.pair] = kappa;
      const auto before = before_.find(row.pair);
      if (!policy_.per_iteration() || before == before_.end()) continue;
      change =
          std::max(change, relative_change(static_cast<double>(before->second), static_cast<double>(kappa)));
    }
    before_ = now;
    return change;
  }
  /// The rows of a trial, which may be accepted.
  void freeze(const std::vector<RowSums>& rows, bool accepted) {
    std::map<PairId, long double> came_with;
    for (const RowSums& row : rows) {
      const bool is_new = known_.find(row.pair) == known_.end();
      n_new += is_new;
      const long double kappa =
          expect(row, row.d_hat, policy_.has_potential() || (accepted && !policy_.per_iteration()));
      if (!is_new) came_with[row.pair] = kappa;
    }
    if (accepted) before_ = came_with;
  }
  double worst = 0;  // relative
  int n_new = 0, n_infinite = 0;

 private:
  struct Parts {
    long double fixed, per_gap_sq;
  };
  Parts parts(const RowSums& row, double d) const {
    const std::string_view term = policy_.mass_term;
    const long double h = time_.dt, c = time_.c, d_hat = row.d_hat, mass = row.mass * policy_.scale;
    long double fixed = policy_.elastic ? row.elastic * policy_.scale : 0, per_gap_sq = 0;
    if (term == "inertia") fixed += mass / (c * h * h);
    if (term == "paper") per_gap_sq = mass;
    if (term == "scaled") per_gap_sq = mass / (c * h * h) * d_hat * d_hat;
    if (policy_.has_potential()) return {fixed, per_gap_sq};
    const long double asked = std::max<long double>(d, policy_.gap_floor * d_hat);
    return {per_gap_sq == 0 ? fixed : fixed + per_gap_sq / (asked * asked), 0};
  }
  /// Of a known pair, else of the policy at d.
  long double expect(const RowSums& row, double d, bool keep) {
    const auto known = known_.find(row.pair);
    const Parts of = known != known_.end() ? known->second : parts(row, d);
    if (keep) known_.emplace(row.pair, of);
    const long double gap = row.d;
    const long double kappa = of.per_gap_sq == 0 ? of.fixed : of.fixed + of.per_gap_sq / (gap * gap);
    if (std::isinf(static_cast<double>(kappa))) {  // M/d^2 of a pair that touches
      EXPECT_EQ(row.kappa, static_cast<double>(kappa));
      ++n_infinite;
    } else {
      worst = std::max(worst, static_cast<double>(std::abs(row.kappa - kappa) / kappa));
    }
    return kappa;
  }

  const Policy& policy_;
  StiffnessTime time_;
  std::map<PairId, Parts> known_;
  std::map<PairId, long double> before_;
};

}  // namespace bb::test::stiffness_update_test
