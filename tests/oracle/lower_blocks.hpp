// Whole matrices and their lower blocks, written without core/math/lower_blocks.hpp's numbering.
#pragma once

#include <vector>

#include "core/math/types.hpp"

namespace bb::test {

/// The symmetric 3 w x 3 w matrix whose lower blocks, nine numbers each and column by column,
/// begin at `blocks`.
inline Eigen::MatrixXd from_lower_blocks(const double* blocks, int w) {
  Eigen::MatrixXd m(3 * w, 3 * w);
  for (int b = 0; b < w; ++b) {
    for (int a = b; a < w; ++a, blocks += 9) {
      const Eigen::Map<const Eigen::Matrix3d> block(blocks);
      m.block<3, 3>(3 * b, 3 * a) = block.transpose();
      m.block<3, 3>(3 * a, 3 * b) = block;
    }
  }
  return m;
}

/// The other way, behind what `blocks` holds already.
inline void append_lower_blocks(const Eigen::MatrixXd& m, std::vector<double>& blocks) {
  for (Eigen::Index b = 0; b < m.cols(); b += 3) {
    for (Eigen::Index a = b; a < m.rows(); a += 3) {
      const Eigen::Matrix3d block = m.block<3, 3>(a, b);
      blocks.insert(blocks.end(), block.data(), block.data() + 9);
    }
  }
}

}  // namespace bb::test
