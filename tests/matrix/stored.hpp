// Stored systems of the tests.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "experiments/matrix/matrix_market.hpp"
#include "experiments/matrix/system_file.hpp"

namespace bb {

inline void write_file(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// A chain of springs with given diagonal: tridiagonal, n rows.
inline StoredSystem chain(int n, double diagonal) {
  StoredSystem out;
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, diagonal);
    if (i > 0) entries.emplace_back(i, i - 1, -1);
  }
  out.system.lower.resize(n, n);
  out.system.lower.setFromTriplets(entries.begin(), entries.end());
  for (int i = 0; i <= n; i += 3) out.system.block_start.push_back(i);
  if (out.system.block_start.back() != n) out.system.block_start.push_back(n);
  out.system.pattern_id = 1;
  out.rhs = VecXd::LinSpaced(n, 0.1, 1.7);
  return out;
}

}  // namespace bb
