// Recognises an unchanged pattern, so that symbolic work can be kept.
#pragma once

#include "core/base/archive/archive.hpp"
#include "core/linear/block_system.hpp"

namespace bb {

/// pattern_id with the sizes; id 0 means unknown and never matches.
class PatternKey {
 public:
  /// True when `system` has the pattern of the last call; remembers it.
  bool same_as_last(const ReducedSystem& system) {
    const bool same = system.pattern_id != 0 && system.pattern_id == id_ && system.lower.rows() == n_ &&
                      system.lower.nonZeros() == n_nonzeros_;
    id_ = system.pattern_id;
    n_ = system.lower.rows();
    n_nonzeros_ = system.lower.nonZeros();
    return same;
  }
  void forget() { id_ = 0; }
  void keep(Archive& archive) { archive(id_, n_, n_nonzeros_); }

 private:
  std::uint64_t id_ = 0;
  Eigen::Index n_ = -1, n_nonzeros_ = -1;
};

}  // namespace bb
