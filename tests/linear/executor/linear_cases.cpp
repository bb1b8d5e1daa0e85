#include "tests/linear/executor/linear_cases.hpp"

#include <random>

#include "core/linear/symmetric_product.hpp"

namespace bb::exec {

namespace {
std::size_t at(Index i) { return static_cast<std::size_t>(i); }
}  // namespace

OwnedPart::OwnedPart(Executor& executor, const std::vector<Index>& begin, const std::vector<int>& columns,
                     const std::vector<Mat3d>& block)
    : row_begin(executor, "matrix rows"),
      column(executor, "matrix columns"),
      value(executor, "matrix values") {
  std::vector<double> numbers(at(value_count(static_cast<Index>(block.size()))), 0.0);
  for (std::size_t j = 0; j < block.size(); ++j) {
    for (int c = 0; c < 9; ++c) numbers[at(value_index(static_cast<Index>(j), c))] = block[j](c % 3, c / 3);
  }
  row_begin.upload(begin), column.upload(columns), value.upload(numbers);
}

OwnedSystem::OwnedSystem(Executor& executor, const ReducedSystem& system, std::vector<FixedMask> given,
                         bool split)
    : mask(std::move(given)), fixed(executor, "fixed degrees of freedom") {
  fixed.upload(mask);
  SymmetricProduct rows;
  rows.update(system);
  constexpr int n_parts = ExecutorMatrix::most_parts;
  constexpr double share[n_parts] = {0.125, 0.375, 0.25, 0.25};
  std::vector<Index> begin[n_parts];
  std::vector<int> column[n_parts];
  std::vector<Mat3d> block[n_parts];
  std::mt19937_64 random(3);
  for (int r = 0; r < rows.n_blocks(); ++r) {
    for (int part = 0; part < n_parts; ++part) begin[part].push_back(static_cast<Index>(column[part].size()));
    for (int k = rows.row_start()[at(r)]; k < rows.row_start()[at(r) + 1]; ++k) {
      const int c = rows.column()[at(k)];
      const Mat3d b = Eigen::Map<const Mat3d>(rows.block(k)).transpose();
      const int choice =
          split ? static_cast<int>(random() % (n_parts + 2)) : 0;  // a part, or from n_parts on all
      for (int part = 0; part < n_parts; ++part) {
        if (choice < n_parts && choice != part) continue;
        column[part].push_back(c), block[part].push_back(choice == part ? b : Mat3d(share[part] * b));
      }
    }
  }
  for (int part = 0; part < (split ? n_parts : 1); ++part) {
    begin[part].push_back(static_cast<Index>(column[part].size()));
    parts_.push_back(std::make_unique<OwnedPart>(executor, begin[part], column[part], block[part]));
  }
}

ExecutorMatrix OwnedSystem::matrix() const {
  ExecutorMatrix out{};
  for (std::size_t k = 0; k < parts_.size(); ++k) out.part[k] = parts_[k]->view();
  return out;
}

Eigen::MatrixXd restricted(const ReducedSystem& system, const std::vector<FixedMask>& fixed) {
  Eigen::MatrixXd a = dense(system);
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    if (!is_fixed(fixed[at(i / 3)], static_cast<int>(i % 3))) continue;
    a.row(i).setZero(), a.col(i).setZero();
    a(i, i) = 1;
  }
  return a;
}

VecXd restricted(const VecXd& b, const std::vector<FixedMask>& fixed) {
  VecXd out = b;
  for (Eigen::Index i = 0; i < b.size(); ++i) {
    if (is_fixed(fixed[at(i / 3)], static_cast<int>(i % 3))) out[i] = 0;
  }
  return out;
}

std::vector<FixedMask> some_fixed(int n_vertices) {
  std::vector<FixedMask> out = no_fixed(n_vertices);
  for (std::size_t v = 0; v < out.size(); ++v) {
    out[v] = v % 7 == 3    ? FixedMask{7}
             : v % 11 == 5 ? FixedMask{4}
             : v % 13 == 1 ? FixedMask{3}
                           : FixedMask{0};
  }
  return out;
}

std::vector<double> plain(const VecXd& v) { return std::vector<double>(v.data(), v.data() + v.size()); }

}  // namespace bb::exec
