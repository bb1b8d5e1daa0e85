#include "tests/linear/systems.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace bb {

namespace {

std::vector<int> starts_of_three(int n) {
  std::vector<int> start;
  for (int i = 0; i < n; i += 3) start.push_back(i);
  start.push_back(n);
  return start;
}

}  // namespace

ReducedSystem from_sparse(const Eigen::SparseMatrix<double>& a, std::uint64_t id) {
  ReducedSystem system;
  system.lower = a.triangularView<Eigen::Lower>();
  system.lower.makeCompressed();
  system.block_start = starts_of_three(static_cast<int>(a.rows()));
  system.pattern_id = id;
  return system;
}

ReducedSystem from_dense(const Eigen::MatrixXd& a, std::uint64_t id) {
  return from_sparse(a.sparseView(1, 0), id);
}

Eigen::MatrixXd dense(const ReducedSystem& system) {
  return Eigen::MatrixXd(system.lower).selfadjointView<Eigen::Lower>();
}

Eigen::MatrixXd with_spectrum(const VecXd& spectrum, unsigned seed) {
  using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  using Vector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Matrix a = spectrum.cast<long double>().asDiagonal();
  for (int k = 0; k < 4; ++k) {
    const Vector v = Vector::NullaryExpr(a.rows(), [&] { return uniform(random); }).normalized();
    const Vector av = a * v;
    const long double vav = v.dot(av);
    a += -2 * v * av.transpose() - 2 * av * v.transpose() + 4 * vav * v * v.transpose();
  }
  return a.cast<double>();
}

Eigen::SparseMatrix<double> sparse_with_spectrum(const VecXd& spectrum, unsigned seed) {
  using Sparse = Eigen::SparseMatrix<long double>;
  const int n = static_cast<int>(spectrum.size());
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<long double> angle(0.3L, 1.2L);
  std::vector<int> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  Sparse a(n, n);
  for (int i = 0; i < n; ++i) a.insert(i, i) = spectrum[i];
  for (int layer = 0; layer < 3; ++layer) {
    std::shuffle(order.begin(), order.end(), random);
    std::vector<Eigen::Triplet<long double>> entries;
    for (std::size_t k = 0; k + 1 < order.size(); k += 2) {
      const long double t = angle(random);
      entries.emplace_back(order[k], order[k], std::cos(t));
      entries.emplace_back(order[k + 1], order[k + 1], std::cos(t));
      entries.emplace_back(order[k], order[k + 1], std::sin(t));
      entries.emplace_back(order[k + 1], order[k], -std::sin(t));
    }
    if (order.size() % 2) entries.emplace_back(order.back(), order.back(), 1.0L);
    Sparse q(n, n);
    q.setFromTriplets(entries.begin(), entries.end());
    a = Sparse(q * a * Sparse(q.transpose()));
  }
  return a.cast<double>();
}

VecXd spectrum(const std::string& kind, int n, double cond, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  VecXd s(n);
  for (int i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) / (n - 1);
    if (kind == "geometric") s[i] = std::pow(cond, t - 1);
    if (kind == "linear") s[i] = 1 / cond + t * (1 - 1 / cond);
    if (kind == "inverse_linear") s[i] = 1 / (cond + t * (1 - cond));
    if (kind == "log_uniform") s[i] = std::pow(cond, -uniform(random));
    if (kind == "two_clusters")
      s[i] = i < n / 2 ? (1 + 0.01 * uniform(random)) / cond : 1 - 0.01 * uniform(random);
    if (kind == "few_outliers") s[i] = (1 + uniform(random)) / std::sqrt(cond);
    if (kind == "multiple_ends") s[i] = i < 6 ? 1 / cond : i >= n - 6 ? 1 : std::pow(cond, t - 1);
    if (kind == "near_multiple_ends") {
      s[i] = i < 6        ? (1 + 1e-7 * i) / cond
             : i >= n - 6 ? 1 - 1e-7 * (n - 1 - i)
                          : std::pow(cond, -0.2 - 0.6 * t);
    }
  }
  s[0] = 1 / cond;
  s[n - 1] = 1;
  return s;
}

const std::vector<std::string>& spectrum_kinds() {
  static const std::vector<std::string> kinds = {
      "geometric",    "linear",       "inverse_linear", "log_uniform",
      "two_clusters", "few_outliers", "multiple_ends",  "near_multiple_ends"};
  return kinds;
}

ReducedSystem grid_system(int m, double diagonal, std::uint64_t id) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Eigen::Triplet<double>> entries;
  const auto couple = [&](int u, int v) {
    Mat3d b = Mat3d::NullaryExpr([&] { return uniform(random); });
    b = (b * b.transpose()).eval();
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) {
        entries.emplace_back(3 * u + r, 3 * u + c, b(r, c));
        entries.emplace_back(3 * v + r, 3 * v + c, b(r, c));
        entries.emplace_back(3 * u + r, 3 * v + c, -b(r, c));
        entries.emplace_back(3 * v + r, 3 * u + c, -b(c, r));
      }
    }
  };
  for (int i = 0; i < m; ++i) {
    for (int j = 0; j < m; ++j) {
      if (i + 1 < m) couple(i * m + j, (i + 1) * m + j);
      if (j + 1 < m) couple(i * m + j, i * m + j + 1);
    }
  }
  for (int k = 0; k < 3 * m * m; ++k) entries.emplace_back(k, k, diagonal);
  Eigen::SparseMatrix<double> a(3 * m * m, 3 * m * m);
  a.setFromTriplets(entries.begin(), entries.end());
  return from_sparse(a, id);
}

ReducedSystem folded_grid(int m, double stiffness) {
  const ReducedSystem grid = grid_system(m, 1e-3, 1);
  std::vector<Eigen::Triplet<double>> entries;
  const int n = m * m;
  for (int v = 0; v < n / 2; ++v) {
    for (int k = 0; k < 3; ++k) {
      const int a = 3 * v + k, b = 3 * (n - 1 - v) + k;
      entries.emplace_back(a, a, stiffness);
      entries.emplace_back(b, b, stiffness);
      entries.emplace_back(b, a, -stiffness);
    }
  }
  Eigen::SparseMatrix<double> springs(3 * n, 3 * n);
  springs.setFromTriplets(entries.begin(), entries.end());
  ReducedSystem out = grid;
  out.lower += springs;
  out.lower.makeCompressed();
  return out;
}

VecXd random_vector(Eigen::Index n, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  return VecXd::NullaryExpr(n, [&] { return uniform(random); });
}

}  // namespace bb
