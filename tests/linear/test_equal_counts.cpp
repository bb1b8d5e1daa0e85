// Patterns with equal numbers of rows and entries, one after the other through one solver: what it keeps of the first would fit the
// second by its size alone. The truth is a dense matrix that is summed here.
#include <gtest/gtest.h>

#include <set>

#include "tests/linear/every_solver.hpp"
#include "tests/linear/systems.hpp"
#include "tests/oracle/dense.hpp"

namespace bb::equal_counts_test {
namespace {

constexpr int n = 14;

Mat3d some_stiffness(int seed) {
  const VecXd r = random_vector(9, static_cast<unsigned>(seed));
  const Mat3d a = Eigen::Map<const Mat3d>(r.data());
  return a * a.transpose() + Mat3d::Identity();
}

/// A chain of vertices, and one pair that a contact joins: whichever that is, there are as many blocks.
class Chain {
 public:
  Chain() : blocks_(n, std::vector<std::uint8_t>(3 * n, 0)) {
    for (int v = 0; v + 1 < n; ++v) edges_.insert(edges_.end(), {v, v + 1});
    blocks_.set_elements({{2, edges_}});
    Positions x = Positions::Zero(3, n);
    for (int v = 0; v < n; ++v) x(0, v) = v;
    blocks_.set_mesh(x);
  }
  const ReducedSystem& joined(int a, int b, int seed) {
    truth_ = Eigen::MatrixXd::Identity(3 * n, 3 * n);
    contact_ = {a, b};
    blocks_.set_contacts({{2, contact_}});
    std::vector<double> elements, contacts;
    for (int v = 0; v + 1 < n; ++v) add(v, v + 1, some_stiffness(100 * seed + v), elements);
    add(a, b, 20 * some_stiffness(seed), contacts);
    blocks_.clear();
    blocks_.add_diagonal(std::vector<double>(n, 1.0));
    blocks_.add_elements(0, elements);
    blocks_.add_contacts(0, contacts);
    return blocks_.reduce(blocks_.values());
  }
  const Eigen::MatrixXd& truth() const { return truth_; }

 private:
  void add(int a, int b, const Mat3d& k, std::vector<double>& out) {
    for (const double sign : {1.0, -1.0, 1.0}) {
      const Mat3d block = sign * k;
      out.insert(out.end(), block.data(), block.data() + 9);
    }
    truth_.block<3, 3>(3 * a, 3 * a) += k;
    truth_.block<3, 3>(3 * b, 3 * b) += k;
    truth_.block<3, 3>(3 * a, 3 * b) -= k;
    truth_.block<3, 3>(3 * b, 3 * a) -= k;
  }
  BlockSystem blocks_;
  std::vector<int> edges_, contact_;
  Eigen::MatrixXd truth_;
};

constexpr int pairs[][2] = {{0, 6}, {1, 7}, {3, 12}, {0, 6}, {2, 9}, {0, 13}, {1, 7}};

TEST(EqualCounts, HavePatternsOfTheirOwn) {
  Chain chain;
  std::set<Eigen::Index> entries;
  std::set<std::uint64_t> ids;
  std::map<std::pair<int, int>, std::uint64_t> known;
  for (int k = 0; k < std::ssize(pairs); ++k) {
    const ReducedSystem& system = chain.joined(pairs[k][0], pairs[k][1], k);
    EXPECT_TRUE(dense(system).isApprox(chain.truth(), 1e-14)) << k;
    entries.insert(system.lower.nonZeros());
    ids.insert(system.pattern_id);
    const auto [place, fresh] = known.insert({{pairs[k][0], pairs[k][1]}, system.pattern_id});
    EXPECT_EQ(place->second, system.pattern_id) << k;
  }
  EXPECT_EQ(entries.size(), 1U);
  EXPECT_EQ(ids.size(), 5U);
  EXPECT_FALSE(ids.contains(0));
}

TEST(EqualCounts, AreSolvedEachAsItself) {
  std::size_t judged = 0;
  for (NamedSolver& each : every_solver()) {
    each.options.parameters["forcing"] = std::string("fixed");
    each.options.parameters["tol_rel"] = 1e-11;
    const auto solver = make_linear_solver(each.options);
    Chain chain;
    for (int k = 0; k < std::ssize(pairs); ++k) {
      const ReducedSystem& system = chain.joined(pairs[k][0], pairs[k][1], k);
      const VecXd b = random_vector(3 * n, 5);
      VecXd x;
      const LinearReport report = solver->solve(system, b, x);
      EXPECT_EQ(report.status, LinearStatus::ok) << each.name << " " << k;
      EXPECT_LT((b - chain.truth() * x).norm(), 1e-9 * b.norm()) << each.name << " " << k;
      ++judged;
    }
  }
  EXPECT_GE(judged, 7U * 8U);
}

}  // namespace
}  // namespace bb::equal_counts_test
